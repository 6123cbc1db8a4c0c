// SPDX-License-Identifier: MIT
#include "runtime/fem/rotation_lanes.hpp"

#include "runtime/fem/polar_rotation.hpp"

namespace souple {

void store_hard_rotations(const LaneMat3& f, const LaneRotations& found, Index count, Mat3* rotations) {
  Mat3 gradients[lane_count], matrices[lane_count];
  store_matrices(f, gradients);
  store_matrices(found.matrices, matrices);
  for (Index lane = 0; lane < count; ++lane)
    rotations[lane] = found.is_good >> lane & 1 ? matrices[lane] : polar_rotation(gradients[lane]);
}

}  // namespace souple
