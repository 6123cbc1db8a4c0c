// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/compress_by_solves.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>
#include <string>

#include "tools/compliance/block_sampler.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/compliance/node_scale.hpp"
#include "tools/compliance/peeling.hpp"
#include "tools/compliance/scaled_inverse.hpp"
#include "tools/compliance/selected_inverse.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {
namespace {

// Shares of the tolerance that sampling and truncation may take in every block; on the bodies measured
// the whole matrix then stays within a third of the tolerance.
constexpr double sampled_share = 0.1, truncated_share = 0.15;
// What the worst column may have of an even spread of errors over all columns.
constexpr double uneven_share = 0.6;
// Column norms come from so many random signs, to about a tenth.
constexpr Eigen::Index norm_probes = 64, noise_probes = 8;
constexpr std::uint64_t norm_key = 1001, noise_key = 1002;  // of signs that no level uses
// Smooth vectors that are solved for in double.
constexpr Eigen::Index deflated_vectors = 64;
// Rounding errors of products hide in sampling if they stay below this multiple of its bound.
constexpr double noise_share = 0.75;
// Above this multiple of it they would take a third of the tolerance.
constexpr double hopeless_share = 1 / (3 * sampled_share);
// Fractions of the progress: the factor, then what is done before sampling.
constexpr double factor_progress = 0.08, prepared_progress = 0.12;

struct Scaling {
  std::vector<std::array<float, 6>> stored;  ///< L_a of C
  std::vector<Mat3> of_unit;                 ///< L_a of unit C
  PeelingOptions bounds;
};

class Compression {
 public:
  Compression(const SolveCompressionOptions& options, std::span<const Point> positions)
      : options_(options), positions_(positions), pool_(options.threads) {}

  Result<CompressedBySolves> run(const BlockMatrix& a0, std::span<const Index> free_nodes,
                                 std::span<const Index> surface_nodes) {
    auto inverse = SurfaceInverse::create(a0, free_nodes, surface_nodes, inverse_limits());
    if (!inverse) return inverse.issue();
    inverse_ = std::move(*inverse);
    result_.report.factor_bytes = inverse_->factor().bytes();
    if (auto status = check_memory(); !status) return status.issue();
    auto scaling = find_scaling();
    if (!scaling) return scaling.issue();
    result_.matrix.depth = cluster_depth(Index(positions_.size()), options_.leaf_nodes);
    result_.matrix.order = cluster_order(positions_);
    result_.matrix.scale = std::move(scaling->stored);
    ScaledInverse scaled(*inverse_, result_.matrix.order, scaling->of_unit);
    if (auto status = quieten(scaled, scaling->bounds); !status) return status.issue();
    if (stopped()) return interruption();
    auto peeled = sample(scaled, scaling->bounds);
    if (!peeled) return peeled.issue();
    keep(std::move(*peeled));
    return std::move(result_);
  }

 private:
  bool stopped() const { return options_.cancelled && options_.cancelled(); }
  static Issue interruption() { return make_issue(IssueCode::interrupted, "the solves were stopped"); }

  std::function<void(double)> progress_part(double begin, double end) const {
    if (!options_.progress) return {};
    return [this, begin, end](double part) { options_.progress(begin + (end - begin) * part); };
  }

  SurfaceInverse::Limits inverse_limits() const {
    return {options_.memory_limit_bytes, pool_.threads(), progress_part(0, factor_progress),
            options_.cancelled};
  }

  /// What stays for all of the work: factor, matrix, smooth vectors and every thread's panels.
  std::size_t fixed_bytes() const {
    const auto surface = 3 * positions_.size();
    const auto unknowns = std::size_t(inverse_->factor().size());
    std::size_t panel = sizeof(float) * (unknowns + 3 * surface) * peeling_columns;
    if (result_.report.refined) panel += sizeof(double) * (4 * unknowns + surface) * peeling_columns;
    return inverse_->bytes() + pool_.threads() * panel +
           sizeof(float) * 2 * surface * std::size_t(deflated_vectors);
  }

  Status check_memory() {
    const std::size_t selected = inverse_->bytes() + selected_inverse_bytes(inverse_->factor());
    const std::size_t needed = std::max(fixed_bytes(), selected);
    result_.report.planned_bytes =
        std::max({result_.report.planned_bytes, inverse_->peak_bytes(), needed});
    if (needed <= options_.memory_limit_bytes) return {};
    return make_issue(IssueCode::compliance_out_of_memory,
                      "solves for " + std::to_string(positions_.size()) + " surface nodes need " +
                          std::to_string(needed / 1000000) + " MB, allowed are " +
                          std::to_string(options_.memory_limit_bytes / 1000000) + " MB");
  }

  Result<Scaling> find_scaling() {
    Scaling scaling;
    return options_.norm == ErrorNorm::scaled_spectral ? scale_by_blocks(scaling)
                                                       : scale_by_columns(scaling);
  }

  void store_scale(const Mat3& factor_of_unit, Scaling& scaling) const {
    // The unit is a power of four: the rounded factors of C and of unit C are the same but for a power
    // of 2.
    const double root = std::sqrt(inverse_->factor().unit());
    scaling.stored.push_back(rounded_scale(factor_of_unit / root));
    scaling.of_unit.push_back(root * scale_matrix<double>(scaling.stored.back()));
  }

  Result<Scaling> scale_by_blocks(Scaling& scaling) {
    const auto blocks =
        inverse_diagonal_blocks(inverse_->factor(), inverse_->places(), options_.cancelled);
    if (blocks.empty()) return interruption();
    for (const Mat3& block : blocks) {
      const Eigen::LLT<Mat3> cholesky(block);
      if (cholesky.info() != Eigen::Success || !block.allFinite())
        return make_issue(IssueCode::compliance_factorisation_failed,
                          "the compliance of a node with itself is not positive definite");
      store_scale(cholesky.matrixL(), scaling);
    }
    scaling.bounds.sampled_bound = sampled_share * options_.tolerance;
    scaling.bounds.truncated_bound = truncated_share * options_.tolerance;
    return std::move(scaling);
  }

  // Frobenius: one constant. Worst column: the roots of the column norms; errors of one size e in all
  // entries then make column j's s_j e ||s|| of s_j^2, which is worst where s_j is least.
  Result<Scaling> scale_by_columns(Scaling& scaling) {
    const Eigen::VectorXd norms = column_norms();
    if (norms.size() == 0) return interruption();
    if (!norms.allFinite() || !(norms.minCoeff() > 0))
      return make_issue(IssueCode::compliance_factorisation_failed,
                        "a column of the compliance is zero or not finite");
    const double mean = norms.norm() / std::sqrt(double(norms.size()));
    const bool constant = options_.norm == ErrorNorm::frobenius;
    for (Eigen::Index row = 0; row < norms.size(); row += 3)
      store_scale(constant ? Mat3(std::sqrt(mean) * Mat3::Identity())
                           : Mat3(norms.segment<3>(row).cwiseSqrt().asDiagonal()),
                  scaling);
    // Of all of C~, whose entries are s_i^-1 C_ij s_j^-1.
    const double size = double(norms.size());
    const double whole =
        constant ? std::sqrt(size) : uneven_share * size * std::sqrt(norms.minCoeff() / norms.sum());
    scaling.bounds.frobenius = true;
    scaling.bounds.sampled_bound = sampled_share * options_.tolerance * whole;
    scaling.bounds.truncated_bound = truncated_share * options_.tolerance * whole;
    return std::move(scaling);
  }

  /// Of unit C, from random signs; empty if stopped.
  Eigen::VectorXd column_norms() {
    const auto size = 3 * Eigen::Index(positions_.size());
    Eigen::MatrixXf probes(size, norm_probes);
    fill_signs(norm_key, 0, 0, probes);
    SurfaceInverse::Work work;
    if (stopped()) return {};
    inverse_->apply_single(inverse_->places(), probes, work);
    return (probes.cast<double>().rowwise().squaredNorm() / double(norm_probes)).cwiseSqrt();
  }

  /// Largest bound that rounding errors of this size hide in, at the root.
  static double hidden(double noise, const PeelingOptions& bounds, Eigen::Index size) {
    const double rows = std::sqrt(double(size) / 2);
    return noise * (bounds.frobenius ? rows : rows / std::sqrt(double(norm_probes)) + 1);
  }

  /// Rounding errors of products: measured, and lowered as far as the tolerance needs it.
  Status quieten(ScaledInverse& scaled, PeelingOptions& bounds) {
    const Eigen::Index size = scaled.size();
    SurfaceInverse::Work work;
    Eigen::MatrixXf signs(size, noise_probes);
    fill_signs(noise_key, 0, 0, signs);
    Eigen::MatrixXd exact = signs.cast<double>();
    scaled.apply_refined(exact, work);
    scaled.apply(signs, work);
    const double count = double(exact.size());
    bounds.noise = (signs.cast<double>() - exact).norm() / std::sqrt(count);
    if (!std::isfinite(bounds.noise) ||
        hidden(bounds.noise, bounds, size) > noise_share * bounds.sampled_bound) {
      scaled.refine();
      result_.report.refined = true;
      bounds.noise = (exact.cast<float>().cast<double>() - exact).norm() / std::sqrt(count);
    } else {
      scaled.deflate(deflated_vectors, pool_);
    }
    result_.report.noise = bounds.noise;
    if (hidden(bounds.noise, bounds, size) <= hopeless_share * bounds.sampled_bound)
      return check_memory();
    return make_issue(IssueCode::compliance_tolerance_missed,
                      "asked for " + std::to_string(options_.tolerance) +
                          ", beyond what products in single precision resolve");
  }

  Result<PeeledMatrix> sample(const ScaledInverse& scaled, PeelingOptions bounds) {
    std::vector<SurfaceInverse::Work> work(pool_.threads());
    PeelingProblem problem{Index(positions_.size()), result_.matrix.depth, {}};
    problem.apply = [&](FloatRef x, unsigned worker) {
      if (stopped()) return false;
      scaled.apply(x, work[worker]);
      return true;
    };
    bounds.threads = pool_.threads();
    bounds.memory_limit_bytes = options_.memory_limit_bytes - fixed_bytes();
    bounds.progress = progress_part(prepared_progress, 1);
    return peel(problem, bounds);
  }

  void keep(PeeledMatrix peeled) {
    result_.report.right_sides = peeled.products;
    result_.report.planned_bytes =
        std::max(result_.report.planned_bytes, fixed_bytes() + peeled.planned_bytes);
    for (int level = 0; level < result_.matrix.depth; ++level) {
      Eigen::Index rank = 0;
      for (Index i = 0; i < Index{1} << level; ++i)
        rank = std::max(rank, peeled.blocks[std::size_t(block_of_cluster(level, i))].singular.size());
      result_.report.level_rank.push_back(Index(rank));
    }
    result_.matrix.blocks = std::move(peeled.blocks);
    result_.matrix.leaves = std::move(peeled.leaves);
    result_.exact = std::move(inverse_);
  }

  const SolveCompressionOptions& options_;
  std::span<const Point> positions_;
  WorkerPool pool_;
  std::unique_ptr<SurfaceInverse> inverse_;
  CompressedBySolves result_;
};

Status check_input(std::span<const Index> free_nodes, std::span<const Index> surface_nodes,
                   std::span<const Point> positions, double tolerance) {
  if (!(tolerance > 0 && tolerance <= 0.5))
    return make_issue(IssueCode::compliance_tolerance_missed,
                      "a tolerance of " + std::to_string(tolerance) + " is outside (0, 0.5]");
  if (surface_nodes.empty() || positions.size() != surface_nodes.size() ||
      !std::ranges::includes(free_nodes, surface_nodes))
    return make_issue(IssueCode::compliance_region_empty,
                      std::to_string(surface_nodes.size()) + " surface nodes with " +
                          std::to_string(positions.size()) + " positions among " +
                          std::to_string(free_nodes.size()) + " free nodes");
  return {};
}

}  // namespace

Result<CompressedBySolves> compress_by_solves(const BlockMatrix& a0, std::span<const Index> free_nodes,
                                              std::span<const Index> surface_nodes,
                                              std::span<const Point> positions,
                                              const SolveCompressionOptions& options) {
  if (auto status = check_input(free_nodes, surface_nodes, positions, options.tolerance); !status)
    return status.issue();
  try {
    return Compression(options, positions).run(a0, free_nodes, surface_nodes);
  } catch (const std::bad_alloc&) {
    return make_issue(IssueCode::compliance_out_of_memory, "the solves ran out of memory");
  }
}

}  // namespace souple
