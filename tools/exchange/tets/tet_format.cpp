// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/tet_format.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "tools/exchange/tets/raw_mesh.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

using namespace std::string_view_literals;

struct Extension {
  std::string_view text;
  TetFormat format;
};
constexpr std::array<Extension, 7> extensions{{{".msh", TetFormat::gmsh},
                                               {".mesh", TetFormat::medit},
                                               {".vtk", TetFormat::vtk},
                                               {".vtu", TetFormat::vtu},
                                               {".node", TetFormat::tetgen},
                                               {".ele", TetFormat::tetgen},
                                               {".veg", TetFormat::vega}}};

std::optional<TetFormat> format_of_extension(std::string_view extension) {
  const auto* found =
      std::ranges::find(extensions, std::string_view(lower_case(extension)), &Extension::text);
  return found == extensions.end() ? std::nullopt : std::optional(found->format);
}

std::optional<TetFormat> format_of_content(std::string_view text) {
  if (text.starts_with("# vtk DataFile")) return TetFormat::vtk;
  const std::string_view word = TextCursor(text).peek();
  if (word == "$MeshFormat" || word == "$NOD" || word == "$Comments") return TetFormat::gmsh;
  if (word.starts_with('<') && text.substr(0, 4096).find("<VTKFile") != text.npos)
    return TetFormat::vtu;
  const std::string_view behind_comments = TextCursor(text, {.hash_comments = true}).peek();
  if (behind_comments == "MeshVersionFormatted") return TetFormat::medit;
  if (lower_case(behind_comments) == "*vertices") return TetFormat::vega;
  return std::nullopt;
}

bool has_utf16_mark(std::string_view bytes) {
  return bytes.starts_with("\xFE\xFF"sv) || bytes.starts_with("\xFF\xFE"sv);
}

/// The number 1 that begins every .meshb, in either byte order.
bool is_binary_medit(std::string_view bytes) {
  return bytes.starts_with("\1\0\0\0"sv) || bytes.starts_with("\0\0\0\1"sv);
}

}  // namespace

std::string_view tet_format_name(TetFormat format) {
  static constexpr std::array names{"gmsh"sv, "medit"sv, "vtk"sv, "vtu"sv, "tetgen"sv, "vega"sv};
  return names[static_cast<std::size_t>(format)];
}

bool is_tet_file_name(const std::filesystem::path& file) {
  return format_of_extension(file.extension().string()).has_value();
}

std::string_view without_utf8_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF"sv)) text.remove_prefix(3);
  return text;
}

Result<TetFormat> recognise_tet_format(std::string_view bytes, std::string_view extension) {
  if (bytes.find_first_not_of(" \t\r\n") == bytes.npos)
    return malformed("the file has " + std::to_string(bytes.size()) + " bytes and nothing in them");
  if (has_utf16_mark(bytes)) return unsupported("the text is UTF-16; ASCII and UTF-8 are read");
  if (const auto found = format_of_content(without_utf8_mark(bytes))) return *found;
  const auto named = format_of_extension(extension);
  const bool is_meshb = lower_case(extension) == ".meshb";
  if (is_binary_medit(bytes) && (is_meshb || named == TetFormat::medit))
    return unsupported("binary medit is not read; write it as ascii .mesh");
  if (!named)
    return unsupported("neither the content nor the extension " + quoted(extension) +
                       " belongs to a format that is read");
  if (*named == TetFormat::tetgen || *named == TetFormat::vega) return *named;
  return malformed("the file ends in " + lower_case(extension) + " but does not begin like " +
                   std::string(tet_format_name(*named)));
}

}  // namespace souple
