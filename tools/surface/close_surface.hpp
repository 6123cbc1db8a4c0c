// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/surface/mend.hpp"

namespace souple {

/// The first half of mending: from triangles that should bound a solid to closed oriented manifold
/// shells. Sets `failure` if too much would have to be invented or left out.
void close_surface(Mended& mended);

}  // namespace souple
