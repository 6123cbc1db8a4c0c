// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as text, in both directions, the same everywhere and without the locale.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace souple {

/// The interval a number has to lie in; NaN and infinities never do.
struct NumberRange {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  bool min_open = false;  ///< the end itself is left out
  bool max_open = false;

  bool contains(double value) const;
  std::string text() const;  ///< "[0, 10]", "(0, 1e+12]"
};

/// The whole text as a finite decimal number; nothing else is accepted.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);

/// The shortest text that reads back as the same double, with a dot or an exponent: "0.2", "1e-05".
std::string exact_text(double value);
/// For people: `digits` significant digits.
std::string rounded_text(double value, int digits = 4);

}  // namespace souple
