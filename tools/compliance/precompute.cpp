// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/precompute.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <numeric>
#include <utility>

#include "runtime/compliance/open_variant.hpp"
#include "tools/compliance/check_support.hpp"
#include "tools/compliance/compliance_probes.hpp"
#include "tools/compliance/compliance_system.hpp"
#include "tools/compliance/compress_by_solves.hpp"
#include "tools/compliance/error_measure.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/compliance/surface_gram.hpp"
#include "tools/compliance/tile_encoder.hpp"

namespace souple {
namespace {

// Tiles of 64 nodes: 147 KB in single precision, a chunk that a reader fetches at once.
constexpr Index largest_tile_nodes = 64;
// Residuals and errors of the dense form, exact to its scalars; a sound mesh gives 1e-12.
constexpr double largest_error = 1e-6;
// Single precision is not tried below this tolerance.
constexpr double least_single_tolerance = 1e-4;
// What the computed matrix may take of a tolerance: the rest is for the compression. Where single
// precision takes more, double is tried.
constexpr double largest_share = 1.0 / 16;

std::string scientific(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g", value);
  return text.data();
}

using Progress = std::function<void(double)>;

/// Part [begin, end] of a whole that is reported to `whole`, and never falls back.
class ProgressParts {
 public:
  explicit ProgressParts(Progress whole) : whole_(std::move(whole)) {}
  Progress part(double begin, double end) {
    if (!whole_) return {};
    return [this, begin, end](double fraction) {
      last_ = std::max(last_, begin + (end - begin) * std::clamp(fraction, 0.0, 1.0));
      whole_(last_);
    };
  }

 private:
  Progress whole_;
  double last_ = 0;
};

/// A compliance in memory, with what measures it.
struct Dense {
  std::unique_ptr<const SymmetricSource> source;
  ComplianceProduct product;
  ComplianceError error;  ///< against solves in double: estimates
};

class Precompute {
 public:
  Precompute(const CompliancePrecomputeOptions& options, const CompliancePrecomputeSettings& settings)
      : options_(options), settings_(settings), progress_(settings.progress) {}

  Result<ComplianceVariant> run(PreparedBody& body, const MeshLevel* coarser, const FixedSet* fixed) {
    const MeshLevel& level = body.level();
    if (auto status = make_header(body.material(), fixed); !status) return status.issue();
    if (options_.kind == ComplianceKind::static_equilibrium) {
      if (fixed)
        if (auto status = check_fixed_set(*fixed, level.mesh.nodes.size()); !status)
          return status.issue();
      if (auto status = check_static_support(level.mesh, fixed); !status) return status.issue();
    }
    auto system =
        build_system(body, fixed, options_.nodes, header_.mass_factor, header_.stiffness_factor);
    if (!system) return system.issue();
    if (settings_.way != ComplianceWay::by_solves) {
      const auto order = body.order(system->free_nodes, system->nodes);
      if (!order) return order.issue();
      system->order.assign(order->begin(), order->end());
    }
    if (options_.coarsening == 0) return compute(*system);
    if (!coarser)
      return make_issue(IssueCode::recipe_needs_coarser_level, "there is no level below the finest",
                        options_.name);
    return compute_coarse(*system, level, *coarser);
  }

 private:
  Status make_header(const Material& material, const FixedSet* fixed) {
    const auto refuse = [&](const std::string& what) {
      return Status(make_issue(IssueCode::config_bad_value, what, options_.name));
    };
    if (!(options_.tolerance >= 0 && options_.tolerance <= 0.5))
      return refuse("tolerance " + std::to_string(options_.tolerance) + " is outside [0, 0.5]");
    if (options_.tolerance == 0 && settings_.way == ComplianceWay::by_solves)
      return refuse("solves give the compressed form, which needs a tolerance above 0");
    if (options_.coarsening < 0 || options_.coarsening > 1)
      return refuse("coarsening " + std::to_string(options_.coarsening) + " is neither 0 nor 1");
    header_.name = options_.name;
    header_.kind = options_.kind;
    header_.fixed_set = fixed ? fixed->name : "";
    header_.scalar = options_.scalar;
    header_.tolerance_asked = options_.tolerance;
    header_.error_norm = options_.norm;
    header_.coarsening = options_.coarsening;
    if (options_.kind == ComplianceKind::static_equilibrium) return {};
    const double h = options_.time_step_s;
    if (!(h >= 1e-7 && h <= 10))
      return make_issue(IssueCode::material_out_of_range,
                        "time step " + std::to_string(h) + " s is outside [1e-7, 10]", options_.name);
    header_.time_step_s = h;
    header_.mass_factor = 1 / (h * h) + material.rayleigh_mass_per_s / h;
    header_.stiffness_factor = 1 + material.rayleigh_stiffness_s / h;
    return {};
  }

  Result<ComplianceVariant> compute(const ComplianceSystem& system) {
    if (settings_.way == ComplianceWay::by_solves) return by_solves(system);
    auto variant = densely(system);
    const bool too_large = !variant.ok() && variant.issue().code == IssueCode::compliance_out_of_memory;
    if (too_large && settings_.way == ComplianceWay::automatic && options_.tolerance > 0)
      return by_solves(system);
    return variant;
  }

  // Before the factorisation, which may take long: the matrix alone has to fit.
  Status check_memory(const ComplianceSystem& system, std::size_t scalar_bytes) const {
    const double rows = 3.0 * double(system.nodes.size());
    const double stored = options_.tolerance > 0 ? 0 : options_.scalar == ScalarType::float32 ? 4 : 8;
    const double needed = rows * rows / 2 * (double(scalar_bytes) + stored);
    if (needed <= double(settings_.memory_limit_bytes)) return {};
    return make_issue(IssueCode::compliance_out_of_memory,
                      std::to_string(system.nodes.size()) + " surface nodes need more than " +
                          std::to_string(std::llround(needed / 1e6)) + " MB, allowed are " +
                          std::to_string(settings_.memory_limit_bytes / 1000000) + " MB",
                      options_.name);
  }

  bool single_may_do() const { return options_.tolerance >= least_single_tolerance; }

  Result<ComplianceVariant> densely(const ComplianceSystem& system) {
    if (auto status = check_memory(system, single_may_do() ? 4 : 8); !status) return status.issue();
    auto factor = factorise(system, progress_.part(0, 0.15));
    if (!factor) return factor.issue();
    auto dense = invert(system, *factor);
    if (!dense) return dense.issue();
    header_.error = dense->error;
    return options_.tolerance > 0 ? store_compressed(system, *dense) : store_tiles(system, *dense);
  }

  Result<SupernodalFactor> factorise(const ComplianceSystem& system, Progress progress) const {
    auto factor =
        SupernodalFactor::create(*system.a0, system.free_nodes,
                                 {settings_.memory_limit_bytes, settings_.threads, system.nodes,
                                  system.order, std::move(progress), settings_.cancelled});
    if (factor || factor.issue().code != IssueCode::compliance_factorisation_failed) return factor;
    Issue issue = factor.issue();
    issue.where = system.worst_element;
    return issue;
  }

  template <class Scalar>
  Result<Dense> gram(const ComplianceSystem& system, const SupernodalFactor& factor) {
    auto made = SurfaceGram<Scalar>::create(factor, system.chosen,
                                            {settings_.threads, settings_.memory_limit_bytes,
                                             progress_.part(0.15, 0.6), settings_.cancelled});
    if (!made) return made.issue();
    const SurfaceGram<Scalar>* source = made->get();
    Dense dense;
    dense.product = [source, threads = settings_.threads](const Eigen::MatrixXd& x,
                                                          Eigen::MatrixXd& y) {
      source->multiply(x, y, threads);
    };
    dense.source = std::move(*made);
    auto error = probe_compliance(system, factor, *dense.source, dense.product);
    if (!error) return error.issue();
    dense.error = *error;
    return dense;
  }

  double allowed_error() const { return std::max(largest_error, largest_share * options_.tolerance); }
  bool is_good(const Dense& dense) const {
    return dense.error.solve_residual <= allowed_error() &&
           error_in(dense.error, options_.norm) <= allowed_error();
  }

  // Single precision where its measured error allows it.
  Result<Dense> invert(const ComplianceSystem& system, const SupernodalFactor& factor) {
    if (single_may_do()) {
      auto dense = gram<float>(system, factor);
      if (!dense || is_good(*dense)) return dense;
    }
    auto dense = gram<double>(system, factor);
    if (!dense || is_good(*dense)) return dense;
    return make_issue(IssueCode::compliance_residual_too_large,
                      "A0 C is " + scientific(dense->error.solve_residual) +
                          " from the identity, C is " +
                          scientific(error_in(dense->error, options_.norm)) + " from A0^-1",
                      system.worst_element);
  }

  ComplianceVariant variant_of(const ComplianceSystem& system) {
    ComplianceVariant variant;
    header_.node_count = std::int64_t(system.nodes.size());
    variant.header = header_;
    variant.nodes = system.nodes;
    return variant;
  }

  // The computed matrix is the truth that the scalars are measured against: its own error hides far
  // below theirs, or it would have been refused.
  ComplianceVariant store_tiles(const ComplianceSystem& system, const Dense& dense) {
    const auto count = Index(system.nodes.size());
    const TileLayout layout{count, std::min(count, largest_tile_nodes)};
    header_.error = {.solve_residual = dense.error.solve_residual};
    header_.representation = ComplianceRepresentation::dense_tiled;
    header_.tile_nodes = layout.tile_nodes;
    header_.block_count = layout.block_count();
    header_.block_scalars = layout.block_scalars();
    auto payload = encode_tiles(*dense.source, layout, header_.scalar, header_.error);
    ComplianceVariant variant = variant_of(system);
    variant.payload = std::move(payload);
    return variant;
  }

  EncodeOptions encode_options(double own_error) {
    EncodeOptions encode;
    encode.tolerance = options_.tolerance - own_error;
    encode.norm = options_.norm;
    encode.threads = settings_.threads;
    encode.factor_limit_bytes = std::min(encode.factor_limit_bytes, settings_.memory_limit_bytes);
    encode.progress = progress_.part(0.65, 1);
    encode.cancelled = settings_.cancelled;
    return encode;
  }

  ComplianceVariant store_encoded(const ComplianceSystem& system, EncodedCompliance encoded) {
    header_.representation = ComplianceRepresentation::hierarchical;
    header_.scalar = ScalarType::float32;
    header_.shift = encoded.shift;
    header_.error.scaled_spectral += encoded.error.scaled_spectral;
    header_.error.frobenius += encoded.error.frobenius;
    header_.error.worst_column += encoded.error.worst_column;
    header_.block_count = std::int64_t(encoded.index.leaf_step.size());
    ComplianceVariant variant = variant_of(system);
    variant.hierarchy = std::move(encoded.index);
    variant.payload = std::move(encoded.payload);
    return variant;
  }

  // Finer than low-rank terms in single precision resolve (about 1e-5), plain scalars hold it.
  Result<ComplianceVariant> store_compressed(const ComplianceSystem& system, const Dense& dense) {
    auto variant = store_hierarchical(system, dense);
    if (variant || variant.issue().code != IssueCode::compliance_tolerance_missed) return variant;
    header_.scalar = ScalarType::float32;
    auto tiles = store_tiles(system, dense);
    if (error_in(tiles.header.error, options_.norm) <= options_.tolerance) return tiles;
    header_.scalar = ScalarType::float64;
    return store_tiles(system, dense);
  }

  Result<ComplianceVariant> store_hierarchical(const ComplianceSystem& system, const Dense& dense) {
    if (cancelled()) return interrupted();
    const EncodeOptions encode = encode_options(error_in(dense.error, options_.norm));
    auto matrix = compress_dense(*dense.source, system.positions, encode);
    if (!matrix) return matrix.issue();
    if (cancelled()) return interrupted();
    auto encoded = encode_hierarchical(*matrix, *dense.source, encode);
    if (!encoded) return encoded.issue();
    return store_encoded(system, std::move(*encoded));
  }

  // The sampled form keeps to its share of the tolerance on the bodies that it was tuned on; where it
  // does not, it is sampled again more closely.
  Result<ComplianceVariant> by_solves(const ComplianceSystem& system) {
    Result<ComplianceVariant> variant = sampled(system, options_.tolerance);
    for (const double share : {0.5, 0.25}) {
      if (variant || variant.issue().code != IssueCode::compliance_tolerance_missed) break;
      variant = sampled(system, share * options_.tolerance);
    }
    return variant;
  }

  Result<ComplianceVariant> sampled(const ComplianceSystem& system, double tolerance) {
    SolveCompressionOptions options;
    options.tolerance = tolerance;
    options.norm = options_.norm;
    options.threads = settings_.threads;
    options.memory_limit_bytes = settings_.memory_limit_bytes;
    options.progress = progress_.part(0, 0.65);
    options.cancelled = settings_.cancelled;
    auto compressed =
        compress_by_solves(*system.a0, system.free_nodes, system.nodes, system.positions, options);
    if (!compressed) {
      Issue issue = compressed.issue();
      if (issue.where.empty() && issue.code == IssueCode::compliance_factorisation_failed)
        issue.where = system.worst_element;
      return issue;
    }
    if (auto status = check_solves(system, *compressed->exact); !status) return status.issue();
    if (cancelled()) return interrupted();
    auto encoded = encode_hierarchical(compressed->matrix, *compressed->exact, encode_options(0));
    if (!encoded) return encoded.issue();
    return store_encoded(system, std::move(*encoded));
  }

  Status check_solves(const ComplianceSystem& system, const SymmetricOperator& exact) {
    header_.error = {};
    if (const auto* solves = dynamic_cast<const SurfaceInverse*>(&exact))
      header_.error.solve_residual = probe_solves(system, *solves);
    if (header_.error.solve_residual <= allowed_error()) return {};
    return make_issue(IssueCode::compliance_residual_too_large,
                      "solves leave a residual of " + scientific(header_.error.solve_residual),
                      system.worst_element);
  }

  /// The coarse compliance as the variant stores it, its error measured against the fine one: that is
  /// what the coarser mesh cannot follow, and no tolerance bounds it.
  Result<ComplianceVariant> compute_coarse(const ComplianceSystem& fine, const MeshLevel& level,
                                           const MeshLevel& coarser) {
    auto coarse = build_coarse_system(fine, level, coarser);
    if (!coarse) return coarse.issue();
    auto variant = compute(coarse->system);
    if (!variant) return variant;
    variant->nodes = fine.nodes;
    variant->prolongation = std::move(coarse->prolongation);
    if (auto status = measure_coarse(fine, *variant); !status) return status.issue();
    return variant;
  }

  Status measure_coarse(const ComplianceSystem& fine, ComplianceVariant& variant) {
    auto factor = factorise(fine, {});
    if (!factor) return factor.issue();
    auto exact = gram<float>(fine, *factor);
    if (!exact) return exact.issue();
    auto stored = open_variant(variant);
    if (!stored) return stored.issue();
    measure_stored(*exact->source, **stored, exact->product, variant.header.error);
    return {};
  }

  bool cancelled() const { return settings_.cancelled && settings_.cancelled(); }
  Issue interrupted() const {
    return make_issue(IssueCode::interrupted, "the compliance was stopped", options_.name);
  }

  const CompliancePrecomputeOptions& options_;
  const CompliancePrecomputeSettings& settings_;
  ProgressParts progress_;
  ComplianceHeader header_;
};

}  // namespace

Result<ComplianceVariant> precompute_compliance(PreparedBody& body, const MeshLevel* coarser,
                                                const FixedSet* fixed,
                                                const CompliancePrecomputeOptions& options,
                                                const CompliancePrecomputeSettings& settings) try {
  return Precompute(options, settings).run(body, coarser, fixed);
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::compliance_out_of_memory, "the memory of the machine ran out",
                    options.name);
}

Result<ComplianceVariant> precompute_compliance(const MeshLevel& level, const MeshLevel* coarser,
                                                const Material& material, const FixedSet* fixed,
                                                const CompliancePrecomputeOptions& options,
                                                const CompliancePrecomputeSettings& settings) {
  PreparedBody body(level, material);
  return precompute_compliance(body, coarser, fixed, options, settings);
}

}  // namespace souple
