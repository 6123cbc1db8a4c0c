// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct DecimateOptions {
  std::size_t target_face_count = 0;  ///< faces to keep at most; 0: as few as max_error_m allows
  double max_error_m = 0;             ///< > 0: never farther from the input than this, both ways
};

struct DecimateReport {
  std::size_t face_count_before = 0;
  std::size_t face_count_after = 0;
  double volume_before_m3 = 0;
  double volume_after_m3 = 0;
  double hausdorff_m = 0;                   ///< sampled two-sided distance
  std::size_t self_intersection_count = 0;  ///< of the result: only as many as the input had
  std::vector<std::string> notes;           ///< what was retried or mended
};

struct DecimatedSurface {
  TriangleMesh mesh;
  DecimateReport report;
};

/// Edge collapse (Lindstrom and Turk 1998: volume preserving). The input must be closed, manifold and
/// consistently oriented; otherwise an issue says what is wrong. The result is closed, manifold and, if
/// the input was, free of self-intersection: a result that is not is mended or collapsed less far.
Result<DecimatedSurface> decimate_surface(const TriangleMesh& surface, const DecimateOptions& options);

}  // namespace souple
