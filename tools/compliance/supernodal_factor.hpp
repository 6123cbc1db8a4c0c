// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// The factor L of P A P^T = L L^T, supernode by supernode in postorder: the columns of supernode s are
/// [first_column[s], first_column[s + 1]); its rows, own columns first and then those below in
/// ascending order, are row[row_begin[s]] to row[row_begin[s + 1] - 1]; its values stand at
/// value[value_begin[s]], column-major, with as many rows as that (above the diagonal: anything).
/// Positions count scalars in elimination order; the three of a node stay together.
struct SupernodeView {
  std::span<const std::int64_t> position_of_node;  ///< [nodes] where the node's first scalar stands
  std::span<const std::int64_t> first_column;      ///< [supernodes + 1]
  std::span<const std::int64_t> row_begin;         ///< [supernodes + 1]
  std::span<const std::int64_t> row;
  std::span<const std::int64_t> value_begin;  ///< [supernodes + 1]
  std::span<const double> value;

  std::size_t count() const { return first_column.size() - 1; }
  std::int64_t columns(std::size_t s) const { return first_column[s + 1] - first_column[s]; }
  std::int64_t rows(std::size_t s) const { return row_begin[s + 1] - row_begin[s]; }
  /// Rows below the own columns.
  std::span<const std::int64_t> below(std::size_t s) const {
    return row.subspan(std::size_t(row_begin[s] + columns(s)), std::size_t(rows(s) - columns(s)));
  }
};

struct FactorOptions {
  std::size_t memory_limit_bytes = std::size_t{16} << 30;
  unsigned threads = 2;  ///< the bits do not depend on it
  /// Nodes whose compliance will be formed, for an order in which that is cheap; empty: none will.
  std::span<const Index> surface{};
  std::span<const Index> order{};                 ///< that of order_nodes, where it is known already
  std::function<void(double fraction)> progress;  ///< may be empty; called from the calling thread
  std::function<bool()> cancelled;                ///< may be empty; the same
};

/// Supernodal Cholesky factor of the part of a block matrix on chosen nodes: ordering and solves by
/// CHOLMOD, numbers by a multifrontal factorisation on several threads. Solves from several threads at
/// once are safe, each with a workspace of its own.
class SupernodalFactor {
 public:
  /// `nodes` ascend. Issues: compliance_factorisation_failed, compliance_out_of_memory, interrupted.
  static Result<SupernodalFactor> create(const BlockMatrix& a, std::span<const Index> nodes,
                                         const FactorOptions& options = {});
  SupernodalFactor(SupernodalFactor&&) noexcept;
  SupernodalFactor& operator=(SupernodalFactor&&) noexcept;
  ~SupernodalFactor();

  std::size_t size() const;  ///< scalars: three per node
  std::size_t bytes() const;
  /// Valid as long as the factor.
  SupernodeView view() const;

  /// Memory for solves with up to `columns` right sides.
  class Workspace {
   public:
    Workspace(const SupernodalFactor& factor, std::size_t columns);
    Workspace(Workspace&&) noexcept;
    ~Workspace();
    /// Right sides, then solutions: size() x columns, by columns.
    std::span<double> right_sides();

   private:
    friend class SupernodalFactor;
    struct State;
    std::unique_ptr<State> state_;
  };

  /// The solutions of the workspace's right sides; valid until its next solve. Empty if memory ran out.
  std::span<const double> solve(Workspace& workspace, std::size_t columns) const;

 private:
  struct State;
  explicit SupernodalFactor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace souple
