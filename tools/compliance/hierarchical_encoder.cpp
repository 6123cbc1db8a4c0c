// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/hierarchical_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "tools/compliance/error_measure.hpp"

namespace souple {
namespace {

// The search aims here and stops in between, in shares of the tolerance.
constexpr double aim = 0.94, close_enough = 0.85;
constexpr int search_rounds = 14;

struct Found {
  double factor = 0;
  QuantisedMatrix quantised;
};

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
    for (int round = 0; round < search_rounds; ++round) {
      auto quantised = quantise(matrix_, shares_, factor, pool_);
      if (!quantised && best) return best;
      const double error = quantised ? error_of(*quantised) : 0;
      if (quantised && error <= bound) {
        low = factor;
        best = Found{factor, std::move(*quantised)};
        if (error >= close_enough * bound) return best;
      } else {
        (quantised ? high : low) = factor;
      }
      factor = next(factor, error > 0 ? aim * bound / error : 4, low, high);
    }
    return best;
  }

 private:
  double error_of(const QuantisedMatrix& quantised) {
    return error_in(measure_.estimate(scaled_hodlr(matrix_, quantised, pool_)).error, options_.norm);
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
  // Scaled entries are about 1 / sqrt(3 n) and less: the first guess matters little.
  double factor = options.tolerance / std::sqrt(3.0 * double(matrix.order.size()));
  double bound = options.tolerance, error = 0;
  for (int attempt = 0; attempt < 4; ++attempt) {
    auto found = search.run(factor, bound);
    if (!found) break;
    const MeasuredError measured = measure.certify(scaled_hodlr(matrix, found->quantised, pool));
    error = error_in(measured.error, options.norm);
    if (error <= options.tolerance) {
      EncodedCompliance encoded = encode_records(matrix, found->quantised, pool);
      encoded.error = measured.error;
      encoded.shift = measured.shift;
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
