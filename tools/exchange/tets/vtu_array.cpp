// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/vtu_array.hpp"

#include <array>

#include "tools/exchange/tets/encoded_bytes.hpp"
#include "tools/exchange/tets/raw_mesh.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

Issue bad_array(const VtuArray& array, const std::string& what) {
  return malformed("the array " + quoted(array.name) + " " + what);
}

std::optional<EncodedBytes> source_of(const VtuArray& array, const VtuEncoding& encoding) {
  if (array.storage == VtuArray::Storage::base64) return EncodedBytes(array.content, false);
  if (array.offset > encoding.appended.size()) return std::nullopt;
  return EncodedBytes(encoding.appended.substr(array.offset), encoding.appended_is_raw);
}

/// Size, data; or count, size of a block, size of the last one if smaller, compressed sizes, blocks.
std::optional<std::string> stored_bytes(EncodedBytes& source, const VtuEncoding& encoding,
                                        std::uint64_t expected) {
  const auto take_size = [&]() -> std::optional<std::uint64_t> {
    const auto bytes = source.take(encoding.size_width);
    if (!bytes) return std::nullopt;
    return encoding.size_width == 4 ? load_number<std::uint32_t>(bytes->data(), encoding.swap)
                                    : load_number<std::uint64_t>(bytes->data(), encoding.swap);
  };
  if (!encoding.compressed) {
    const auto size = take_size();
    return size && *size == expected ? source.take(expected) : std::nullopt;
  }
  const auto block_count = take_size(), block_size = take_size(), last_size = take_size();
  if (!block_count || !block_size || !last_size) return std::nullopt;
  BlockSizes sizes{*block_size, *last_size, {}};
  for (std::uint64_t i = 0; i < *block_count; ++i) {
    const auto size = take_size();  // ends with the source
    if (!size) return std::nullopt;
    sizes.compressed.push_back(*size);
  }
  return inflate_blocks(source, sizes, expected);
}

template <class T, class FromText, class FromBytes>
Result<std::vector<T>> read_values(const VtuArray& array, const VtuEncoding& encoding,
                                   std::size_t count, FromText from_text, FromBytes from_bytes) {
  std::vector<T> values;
  if (array.storage == VtuArray::Storage::text) {
    TextCursor in(array.content);
    values.reserve(in.checked_count(static_cast<std::int64_t>(count), 2, count));
    for (std::size_t i = 0; i < count && in.ok(); ++i) values.push_back(from_text(in));
    if (!in.at_end()) in.fail("there are more numbers than belong there");
    if (!in.ok()) return bad_array(array, "is wrong in its " + in.issue().what);
    return values;
  }
  auto source = source_of(array, encoding);
  const auto bytes = source ? stored_bytes(*source, encoding, count * array.type.width) : std::nullopt;
  if (!bytes)
    return bad_array(array, "does not hold the " + std::to_string(count) + " numbers that it should");
  values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<T> value = from_bytes(bytes->data() + i * array.type.width);
    if (!value) return bad_array(array, "holds a number that is not an integer");
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::optional<NumberType> vtu_number_type(std::string_view name) {
  struct Named {
    std::string_view name;
    NumberType type;
  };
  using enum NumberKind;
  static constexpr std::array<Named, 10> types{{{"Float32", {real, 4}},
                                                {"Float64", {real, 8}},
                                                {"Int8", {signed_integer, 1}},
                                                {"Int16", {signed_integer, 2}},
                                                {"Int32", {signed_integer, 4}},
                                                {"Int64", {signed_integer, 8}},
                                                {"UInt8", {unsigned_integer, 1}},
                                                {"UInt16", {unsigned_integer, 2}},
                                                {"UInt32", {unsigned_integer, 4}},
                                                {"UInt64", {unsigned_integer, 8}}}};
  for (const Named& known : types)
    if (known.name == name) return known.type;
  return std::nullopt;
}

Result<std::vector<double>> vtu_reals(const VtuArray& array, const VtuEncoding& encoding,
                                      std::size_t count) {
  return read_values<double>(
      array, encoding, count, [](TextCursor& in) { return in.number(); },
      [&](const char* at) { return std::optional(load_real(at, array.type, encoding.swap)); });
}

Result<std::vector<std::int64_t>> vtu_integers(const VtuArray& array, const VtuEncoding& encoding,
                                               std::size_t count) {
  return read_values<std::int64_t>(
      array, encoding, count, [](TextCursor& in) { return in.integer(); },
      [&](const char* at) { return load_integer(at, array.type, encoding.swap); });
}

}  // namespace souple
