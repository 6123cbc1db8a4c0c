// SPDX-License-Identifier: GPL-3.0-or-later
// One <DataArray> of a VTU file and its encodings.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/exchange/tets/number_type.hpp"

namespace souple {

/// How the file stores what is not text.
struct VtuEncoding {
  bool swap = false;             ///< numbers are big-endian
  std::size_t size_width = 4;    ///< bytes of the sizes before the data: 4 or 8
  bool compressed = false;       ///< in blocks, by zlib
  std::string_view appended;     ///< what follows the '_' of <AppendedData>
  bool appended_is_raw = false;  ///< else base64
};

struct VtuArray {
  enum class Storage : std::uint8_t { text, base64, appended };
  std::string name;
  NumberType type;
  std::size_t component_count = 1;
  Storage storage = Storage::text;
  std::string_view content;  ///< of text and base64
  std::uint64_t offset = 0;  ///< of appended
};

/// "Float32", "Int64" …
std::optional<NumberType> vtu_number_type(std::string_view name);

/// Exactly `count` numbers. Allocates no more than about a thousand times the bytes of the file, which
/// is what zlib can save. Issue tet_file_malformed.
Result<std::vector<double>> vtu_reals(const VtuArray& array, const VtuEncoding& encoding,
                                      std::size_t count);
Result<std::vector<std::int64_t>> vtu_integers(const VtuArray& array, const VtuEncoding& encoding,
                                               std::size_t count);

}  // namespace souple
