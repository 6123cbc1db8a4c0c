// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// The rotation nearest to `f` in the Frobenius norm: the orthogonal factor of the polar decomposition
/// where det f > 0. Flat and inverted f (det <= 0) get the rotation that flips the least stretched
/// direction (Irving, Teran, Fedkiw 2004), so the result is always in SO(3); f = 0 gives the identity.
/// Error below 1e-12 for det f > 0. `f` must be finite.
Mat3 polar_rotation(const Mat3& f);

}  // namespace souple
