// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string_view>

namespace souple {

inline constexpr std::string_view length_unit_names = "m, cm, mm, um, km, in, ft";

/// Metres per unit of a file's numbers; nothing for a name that is not one of length_unit_names.
inline std::optional<double> metres_per_unit(std::string_view unit) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  constexpr std::array<Unit, 7> units{{{"m", 1},
                                       {"cm", 1e-2},
                                       {"mm", 1e-3},
                                       {"um", 1e-6},
                                       {"km", 1e3},
                                       {"in", 0.0254},
                                       {"ft", 0.3048}}};
  for (const Unit& known : units)
    if (known.name == unit) return known.metres;
  return std::nullopt;
}

}  // namespace souple
