// SPDX-License-Identifier: GPL-3.0-or-later
// The certificate: how far S (C~ + shift I) S^T is from C.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "tools/compliance/hodlr_product.hpp"

namespace souple {

double error_in(const ComplianceError& error, ErrorNorm norm);

/// Errors against C. What a search needs costs less than the full certificate.
class ErrorMeasure {
 public:
  virtual ~ErrorMeasure() = default;
  /// What the other functions measure, until the next one is set; it must outlive them.
  virtual void set_stored(const QuantisedMatrix& stored) = 0;
  /// With the shift; solve_residual untouched. The error in the norm of the options; the others may be
  /// left out.
  virtual ComplianceError estimate(double shift) = 0;
  /// Everything.
  virtual ComplianceError certify(double shift) = 0;
  /// A shift that makes S (C~ + shift I) S^T positive semi-definite, from how far the stored form may
  /// fall below C; during a search a guess that costs less.
  virtual double shift_above() = 0;
  virtual double guessed_shift() { return shift_above(); }
  /// Whether that takes into account how positive C is, so that it often is 0.
  virtual bool knows_floor() const { return false; }
  virtual const Eigen::VectorXd& column_norms() const = 0;  ///< of C, in cluster order
};

/// Frobenius and columns exactly from all entries, in double; eigenvalues by Lanczos on the difference
/// (single precision), raised by 2 %.
std::unique_ptr<ErrorMeasure> make_dense_measure(const HodlrMatrix& matrix,
                                                 const SymmetricSource& source, ErrorNorm norm,
                                                 WorkerPool& pool);
/// By products with C only: columns and Frobenius from 64 random sign vectors, raised by 5 % and
/// (columns, of which the worst counts) 25 %; eigenvalues by block Lanczos, raised by 10 %.
std::unique_ptr<ErrorMeasure> make_operator_measure(const HodlrMatrix& matrix,
                                                    const SymmetricOperator& exact, ErrorNorm norm,
                                                    WorkerPool& pool);

}  // namespace souple
