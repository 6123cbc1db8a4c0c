// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/surface_format.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

namespace souple {
namespace {

using namespace std::string_view_literals;

struct Extension {
  std::string_view text;
  SurfaceFormat format;
  bool is_text;  ///< always text, so that zero bytes betray another encoding
};
constexpr std::array<Extension, 9> extensions{{{".obj", SurfaceFormat::obj, true},
                                               {".off", SurfaceFormat::off, false},
                                               {".ply", SurfaceFormat::ply, false},
                                               {".stl", SurfaceFormat::stl, false},
                                               {".gltf", SurfaceFormat::gltf, true},
                                               {".glb", SurfaceFormat::gltf, false},
                                               {".fbx", SurfaceFormat::fbx, false},
                                               {".dae", SurfaceFormat::collada, true},
                                               {".3ds", SurfaceFormat::three_ds, false}}};

constexpr std::size_t stl_header_bytes = 84, stl_record_bytes = 50;

std::string lower(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

std::uint32_t little_endian_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k)
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

bool has_utf16_mark(std::string_view bytes) {
  return bytes.starts_with("\xFE\xFF"sv) || bytes.starts_with("\xFF\xFE"sv) ||
         bytes.starts_with("\0\0\xFE\xFF"sv);
}

/// The first word that is neither white space nor a '#' comment.
std::string_view first_word(std::string_view text) {
  while (true) {
    const std::size_t start = text.find_first_not_of(" \t\r\n");
    if (start == text.npos) return {};
    text.remove_prefix(start);
    if (text.front() != '#') return text.substr(0, text.find_first_of(" \t\r\n"));
    text.remove_prefix(std::min(text.size(), text.find('\n')));
  }
}

bool is_off_keyword(std::string_view word) {
  for (const std::string_view prefix : {"ST"sv, "C"sv, "N"sv, "4"sv, "n"sv})
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  return word == "OFF";
}

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= stl_header_bytes &&
         (bytes.size() - stl_header_bytes) / stl_record_bytes == little_endian_u32(bytes, 80) &&
         bytes.size() > stl_header_bytes;
}

bool is_ascii_stl(std::string_view text) {
  return lower(first_word(text)) == "solid" &&
         lower(text.substr(0, 4096)).find("facet") != std::string::npos;
}

bool is_3ds(std::string_view bytes) {
  return bytes.size() >= 6 && bytes.starts_with("MM") && little_endian_u32(bytes, 2) <= bytes.size() &&
         little_endian_u32(bytes, 2) >= 6;
}

bool has_obj_line(std::string_view text) {
  return text.starts_with("v ") || text.starts_with("v\t") || text.find("\nv ") != text.npos ||
         text.find("\nv\t") != text.npos || text.find("\rv ") != text.npos;
}

bool is_json_object(std::string_view text) {
  return first_word(text).starts_with('{') && text.find("\"asset\"") != text.npos;
}

std::optional<SurfaceFormat> format_of_content(std::string_view bytes) {
  const std::string_view text = without_byte_order_mark(bytes);
  const std::string_view word = first_word(text);
  if (bytes.starts_with("glTF") || is_json_object(text)) return SurfaceFormat::gltf;
  if (bytes.starts_with("Kaydara FBX Binary") || text.starts_with("; FBX")) return SurfaceFormat::fbx;
  if (word == "ply") return SurfaceFormat::ply;
  if (is_off_keyword(word)) return SurfaceFormat::off;
  if (word.starts_with('<') && text.substr(0, 4096).find("<COLLADA") != text.npos)
    return SurfaceFormat::collada;
  if (is_binary_stl(bytes) || is_ascii_stl(text)) return SurfaceFormat::stl;
  if (is_3ds(bytes)) return SurfaceFormat::three_ds;
  return std::nullopt;
}

}  // namespace

std::string_view surface_format_name(SurfaceFormat format) {
  static constexpr std::array names{"obj"sv,  "off"sv, "ply"sv,     "stl"sv,
                                    "gltf"sv, "fbx"sv, "collada"sv, "3ds"sv};
  return names[static_cast<std::size_t>(format)];
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF"sv)) text.remove_prefix(3);
  return text;
}

Result<SurfaceFormat> recognise_surface_format(std::string_view bytes, std::string_view extension) {
  if (bytes.empty()) return make_issue(IssueCode::surface_empty_file, "the file has 0 bytes");
  if (bytes.find_first_not_of(" \t\r\n") == bytes.npos)
    return make_issue(IssueCode::surface_empty_file, "the file has only white space");
  const std::string wanted = lower(extension);
  const auto* named = std::ranges::find(extensions, std::string_view(wanted), &Extension::text);
  const bool is_known = named != extensions.end();
  if (const auto found = format_of_content(bytes)) return *found;
  if (has_utf16_mark(bytes) || (is_known && named->is_text && bytes.find('\0') != bytes.npos))
    return make_issue(IssueCode::surface_text_encoding, "the text is not ASCII or UTF-8");
  const bool is_text = bytes.find('\0') == bytes.npos;
  if (is_text && has_obj_line(without_byte_order_mark(bytes))) return SurfaceFormat::obj;
  if (!is_known)
    return make_issue(IssueCode::unsupported_surface_format,
                      extension.empty() ? std::string("the file name has no extension")
                                        : "files ending in " + std::string(extension.substr(0, 16)) +
                                              " are not read");
  // What is truncated or holds no vertex at all: the reader says so more precisely.
  if (named->format == SurfaceFormat::obj && is_text) return named->format;
  if (named->format == SurfaceFormat::stl && !is_text && bytes.size() >= stl_header_bytes)
    return named->format;
  if (named->format == SurfaceFormat::three_ds && bytes.starts_with("MM")) return named->format;
  return make_issue(IssueCode::surface_wrong_format,
                    "the file ends in " + wanted + " but does not begin like " +
                        std::string(surface_format_name(named->format)) +
                        (bytes.size() < 84 ? "; it may be truncated" : ""));
}

}  // namespace souple
