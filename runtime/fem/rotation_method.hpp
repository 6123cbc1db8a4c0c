// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace souple {

/// Which rotation a deformation gradient F is given (METHOD 1). All of them give R for F = R.
enum class RotationMethod : std::uint8_t {
  /// The nearest in the Frobenius norm (Etzmuss et al. 2003): the default. R^T F is symmetric, so that
  /// element forces carry no moment.
  polar,
  /// Q of F = Q U with U upper triangular: columns made orthonormal, the first keeps its direction. It
  /// turns with the body, but depends on the axes of the rest frame, and the forces carry a moment.
  qr,
  /// Rows made orthonormal, as OpenTissue does. Does not turn with a body that is strained as well.
  gram_schmidt,
};

}  // namespace souple
