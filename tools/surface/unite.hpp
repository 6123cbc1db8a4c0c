// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/surface/mend.hpp"

namespace souple {

/// Replaces every group of closed shells that cut one another by its union. A group whose union is not
/// sound stays as it is.
void unite_crossing_shells(Mended& mended);

}  // namespace souple
