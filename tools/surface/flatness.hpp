// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Whether all points lie within 1e-7 of their greatest extent from one plane (or line, or point).
bool is_flat(const std::vector<Point>& points);

}  // namespace souple
