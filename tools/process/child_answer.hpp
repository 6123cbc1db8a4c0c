// SPDX-License-Identifier: GPL-3.0-or-later
// What a child process answers: bytes, or the issue that prevented them.
#pragma once
#include <string>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

/// With a checksum; code and text of an issue, not where it was and how to mend it.
std::string seal_answer(const Result<std::string>& answer);

/// The bytes, as untrusted as ever but not truncated or damaged; a view into `sealed`. What is not a
/// sealed answer is surface_reader_crashed. An issue is handed on with its text made printable.
Result<std::string_view> open_answer(std::string_view sealed);

}  // namespace souple
