// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <memory>
#include <span>

#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// Supernodal Cholesky factor (CHOLMOD) of the part of a block matrix on chosen nodes. Solves from
/// several threads at once are safe, each with a workspace of its own.
class SupernodalFactor {
 public:
  /// `nodes` ascend. Issues: compliance_factorisation_failed, compliance_out_of_memory.
  static Result<SupernodalFactor> create(const BlockMatrix& a, std::span<const Index> nodes,
                                         std::size_t memory_limit_bytes);
  SupernodalFactor(SupernodalFactor&&) noexcept;
  SupernodalFactor& operator=(SupernodalFactor&&) noexcept;
  ~SupernodalFactor();

  std::size_t size() const;  ///< scalars: three per node
  std::size_t bytes() const;

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
