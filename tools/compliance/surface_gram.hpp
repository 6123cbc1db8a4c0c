// SPDX-License-Identifier: GPL-3.0-or-later
// C = E^T A^-1 E = Y^T Y with Y = L^-1 E, E choosing nodes: the rest compliance at the speed of dense
// products (no backward solve, and every supernode sees only the chosen columns of its own subtree).
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/compliance/supernodal_factor.hpp"
#include "tools/compliance/symmetric_source.hpp"

namespace souple {

struct GramOptions {
  unsigned threads = 2;  ///< the bits do not depend on it
  std::size_t memory_limit_bytes = std::size_t{16} << 30;
  std::function<void(double fraction)> progress;  ///< may be empty; called from the calling thread
  std::function<bool()> cancelled;                ///< may be empty; the same, before every front
};

/// What it took.
struct GramReport {
  double solve_flops = 0;         ///< forward solves
  double product_flops = 0;       ///< Y^T Y
  std::size_t planned_bytes = 0;  ///< largest amount held at once, the factor included
};

/// The lower triangle of C in square tiles, columns in elimination order; read in the order of the
/// rows.
template <class Scalar>
class SurfaceGram final : public SymmetricSource {
 public:
  static constexpr Index tile_scalars = 768;

  /// `chosen`: nodes of the factor (0 based, as they were numbered for it), one per row. Issues:
  /// compliance_out_of_memory, before anything of that size is allocated; interrupted.
  static Result<std::unique_ptr<SurfaceGram>> create(const SupernodalFactor& factor,
                                                     std::span<const Index> chosen,
                                                     const GramOptions& options);

  Index node_count() const override { return static_cast<Index>(place_.size()); }
  void read(std::span<const Index> rows, std::span<const Index> columns,
            Eigen::Ref<Eigen::MatrixXf> out) const override;
  void read(std::span<const Index> rows, std::span<const Index> columns,
            Eigen::Ref<Eigen::MatrixXd> out) const override;
  /// y = C x in double, rows in their order.
  void multiply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> y,
                unsigned threads) const;
  const GramReport& report() const { return report_; }
  std::size_t bytes() const;

 private:
  SurfaceGram() = default;
  template <class Out>
  void read_as(std::span<const Index> rows, std::span<const Index> columns, Out& out) const;

  std::vector<Index> place_;  ///< [rows] first scalar in elimination order
  std::int64_t size_ = 0;     ///< scalars
  double unit_ = 1;           ///< a power of two: C = unit_ times the tiles, which stay within floats
  std::vector<std::unique_ptr<Scalar[]>> tiles_;
  GramReport report_;
};

/// y = C x by solves with the factor.
class FactorOperator final : public SymmetricOperator {
 public:
  /// Both must outlive the operator.
  FactorOperator(const SupernodalFactor& factor, std::span<const Index> chosen)
      : factor_(factor), chosen_(chosen) {}
  Index node_count() const override { return static_cast<Index>(chosen_.size()); }
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> y) const override;

 private:
  const SupernodalFactor& factor_;
  std::span<const Index> chosen_;
};

}  // namespace souple
