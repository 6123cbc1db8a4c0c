// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/surface/mend.hpp"

namespace souple {

struct WrapTrial {
  double alpha = 0;
  double offset = 0;
  double volume = 0;
  double thickness = 0;  ///< 2 V / A: of a double skin the distance of its two sheets
  double support = 0;    ///< share of the wrap's area near the surface
  std::string flaw;      ///< why it is not taken; empty if it is plausible
};

struct Wrapped {
  TriangleMesh mesh;
  WrapTrial taken;
  std::vector<WrapTrial> trials;  ///< coarse to fine
};

/// Wraps a surface at unit size from coarse to fine and takes the finest wrap that is plausible. With
/// alpha below the size of a hole a wrap enters it and becomes a double skin of the sheet: then its
/// thickness is twice the offset and its volume has collapsed. `max_error` in units; `is_closed` says
/// that nothing can be entered; `volume`, of the surface with its holes filled, serves as a measure if
/// it is > 0. Issues: surface_hopeless if what is there is a sheet at every size, surface_wrap_failed.
Result<Wrapped> wrap_surface(const TriangleMesh& unit, double max_error, bool is_closed, double volume);

}  // namespace souple
