// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct DecimateOptions {
  std::size_t target_face_count = 0;  ///< faces to keep at most; a smaller input is returned as it is
};

struct DecimateReport {
  std::size_t face_count_before = 0;
  std::size_t face_count_after = 0;
  double volume_before_m3 = 0;
  double volume_after_m3 = 0;
  double hausdorff_m = 0;  ///< sampled one-sided distance of the result from the input
};

struct DecimatedSurface {
  TriangleMesh mesh;
  DecimateReport report;
};

/// Edge collapse (Lindstrom and Turk 1998: volume preserving). The input must be closed, manifold and
/// consistently oriented; otherwise an issue says what is wrong. The result is closed and manifold.
Result<DecimatedSurface> decimate_surface(const TriangleMesh& surface, const DecimateOptions& options);

}  // namespace souple
