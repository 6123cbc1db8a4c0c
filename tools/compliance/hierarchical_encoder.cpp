// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/hierarchical_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "tools/compliance/error_measure.hpp"
#include "tools/compliance/hodlr_factor.hpp"

namespace souple {
namespace {

// The search aims here and stops in between, in shares of the tolerance.
constexpr double aim = 0.975, close_enough = 0.93;
constexpr int search_rounds = 14;
constexpr double first_guess = 1.25;

// Positive definite with room to spare: this share of the noise's norm.
constexpr double cushion = 0.02;

struct Found {
  double factor = 0;
  double shift = 0;
  QuantisedMatrix quantised;
};

// Of independent uniform errors within half a step, sqrt(step^2 / 12) each, in 3n x 3n entries.
double noise_norm(double step, std::size_t node_count) { return step * std::sqrt(double(node_count)); }

// The step whose square is the mean over all entries.
double mean_step(const HodlrMatrix& matrix, const QuantisedMatrix& quantised) {
  double sum = 0, entries = 0;
  const auto add = [&](double count, double step) {
    entries += count;
    sum += count * step * step;
  };
  for (std::size_t b = 0; b < quantised.blocks.size(); ++b)
    add(2 * double(matrix.blocks[b].left.rows()) * double(matrix.blocks[b].right.rows()),
        double(quantised.blocks[b].step));
  for (std::size_t leaf = 0; leaf < matrix.leaves.size(); ++leaf)
    add(double(matrix.leaves[leaf].size()), double(quantised.leaf_step[leaf]));
  return std::sqrt(sum / entries);
}

// C~ in double and its factors beside it.
std::size_t factor_bytes(const HodlrMatrix& matrix, const QuantisedMatrix& quantised) {
  std::size_t count = 0;
  for (std::size_t b = 0; b < matrix.blocks.size(); ++b)
    count += quantised.blocks[b].kept.size() *
             std::size_t(matrix.blocks[b].left.rows() + matrix.blocks[b].right.rows());
  return 2 * sizeof(double) * count;
}

// Makes C~ + shift I positive definite by its own least eigenvalue, which is often positive already.
double needed_shift(const HodlrMatrix& matrix, const Found& found, WorkerPool& pool) {
  const double resolution =
      cushion * noise_norm(mean_step(matrix, found.quantised), matrix.order.size());
  ScaledHodlr plain = plain_hodlr(matrix, found.quantised);
  for (Eigen::MatrixXd& leaf : plain.leaves) leaf.diagonal().array() -= resolution;
  return least_positive_shift(plain, resolution, pool);
}

// Errors are about proportional to the steps, so a few corrections of one factor suffice; a bracket
// keeps them from going astray.
class FactorSearch {
 public:
  FactorSearch(const HodlrMatrix& matrix, const StepShares& shares, ErrorMeasure& measure,
               const EncodeOptions& options, WorkerPool& pool)
      : matrix_(matrix), shares_(shares), measure_(measure), options_(options), pool_(pool) {}

  // The largest factor that was found to keep the estimated error within `bound`.
  std::optional<Found> run(double start, double bound) {
    double factor = start, low = 0, high = 0;
    std::optional<Found> best;
    for (int round = 0; round < search_rounds && !is_cancelled(); ++round) {
      auto quantised = quantise(matrix_, shares_, factor, pool_);
      if (!quantised && best) return best;
      double error = 0;
      if (quantised) {
        Found found{factor, 0, std::move(*quantised)};
        error = error_of(found);
        if (error <= bound) best = std::move(found);
      }
      if (quantised && error <= bound) {
        low = factor;
        if (error >= close_enough * bound) return best;
      } else {
        (quantised ? high : low) = factor;
      }
      factor = next(factor, error > 0 ? aim * bound / error : 4, low, high);
    }
    return best;
  }

  bool is_cancelled() const { return options_.cancelled && options_.cancelled(); }

  ComplianceError certify(Found& found) {
    measure_.set_stored(found.quantised);
    find_shift(found, true);
    return measure_.certify(found.shift);
  }

 private:
  bool is_factored(const Found& found) const {
    return factor_bytes(matrix_, found.quantised) <= options_.factor_limit_bytes;
  }

  // Products show a shift that is enough and, where the measure knows how positive C is, often none;
  // factors show the least one.
  void find_shift(Found& found, bool for_certificate) {
    const bool factored = is_factored(found);
    if (measure_.knows_floor() || !factored) {
      found.shift = for_certificate ? measure_.shift_above() : measure_.guessed_shift();
      if (found.shift == 0 || !factored) return;
    } else if (for_certificate) {
      return;  // factors have shown it already
    }
    found.shift = needed_shift(matrix_, found, pool_);
  }

  double error_of(Found& found) {
    measure_.set_stored(found.quantised);
    find_shift(found, false);
    return error_in(measure_.estimate(found.shift), options_.norm);
  }

  static double next(double factor, double correction, double low, double high) {
    const double wished = factor * std::clamp(correction, 1.0 / 64, 64.0);
    if (low > 0 && high > 0 && !(wished > 1.001 * low && wished < 0.999 * high))
      return std::sqrt(low * high);
    return wished;
  }

  const HodlrMatrix& matrix_;
  const StepShares& shares_;
  ErrorMeasure& measure_;
  const EncodeOptions& options_;
  WorkerPool& pool_;
};

Issue missed(const EncodeOptions& options, double error) {
  return make_issue(IssueCode::compliance_tolerance_missed,
                    "asked for " + std::to_string(options.tolerance) +
                        (error > 0 ? ", reached " + std::to_string(error)
                                   : ", beyond what the compressed form resolves"));
}

Result<EncodedCompliance> encode(const HodlrMatrix& matrix, ErrorMeasure& measure,
                                 const EncodeOptions& options, WorkerPool& pool) {
  if (!(options.tolerance > 0 && options.tolerance <= 0.5))
    return make_issue(IssueCode::compliance_tolerance_missed,
                      "a tolerance of " + std::to_string(options.tolerance) + " is outside (0, 0.5]");
  const StepShares shares = step_shares(matrix, measure.column_norms(), options.norm);
  FactorSearch search(matrix, shares, measure, options, pool);
  // Terms that are dropped and blocks of low rank take less than dense blocks would.
  double factor = first_guess * options.tolerance / noise_norm(1, matrix.order.size());
  double bound = options.tolerance, error = 0;
  for (int attempt = 0; attempt < 4; ++attempt) {
    auto found = search.run(factor, bound);
    if (search.is_cancelled()) return make_issue(IssueCode::interrupted, "the compression was stopped");
    if (!found) break;
    const ComplianceError measured = search.certify(*found);
    error = error_in(measured, options.norm);
    if (error <= options.tolerance) {
      EncodedCompliance encoded = encode_records(matrix, found->quantised, pool);
      encoded.error = measured;
      encoded.shift = found->shift;
      if (options.progress) options.progress(1);
      return encoded;
    }
    // The certificate looks closer than the search: ask more of the search.
    bound *= 0.97 * options.tolerance / error;
    factor = 0.97 * found->factor * options.tolerance / error;
  }
  return missed(options, error);
}

}  // namespace

Result<EncodedCompliance> encode_hierarchical(const HodlrMatrix& matrix, const SymmetricSource& source,
                                              const EncodeOptions& options) {
  WorkerPool pool(options.threads);
  const auto measure = make_dense_measure(matrix, source, options.norm, pool);
  return encode(matrix, *measure, options, pool);
}

Result<EncodedCompliance> encode_hierarchical(const HodlrMatrix& matrix, const SymmetricOperator& exact,
                                              const EncodeOptions& options) {
  WorkerPool pool(options.threads);
  const auto measure = make_operator_measure(matrix, exact, options.norm, pool);
  return encode(matrix, *measure, options, pool);
}

}  // namespace souple
