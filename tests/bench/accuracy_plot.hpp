// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

namespace souple::bench {

/// Relative to the uncompressed compliance.
struct SceneError {
  double force = 0, shape = 0;
};

struct AccuracyPoint {
  double tolerance = 0, bytes = 0;
  SceneError drop, grip;
};

/// compliance_accuracy.csv and, bytes against force error on logarithmic axes, compliance_accuracy.svg.
void write_accuracy(const std::vector<AccuracyPoint>& curve, const std::filesystem::path& folder);

}  // namespace souple::bench
