// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>

#include "formats/core/mesh.hpp"

namespace souple {

struct Box {
  Point low{}, high{};
};

/// Of all points; both corners zero if there are none.
Box bounding_box(std::span<const Point> points);
double longest_side(const Box& box);

}  // namespace souple
