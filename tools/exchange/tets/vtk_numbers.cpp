// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/vtk_numbers.hpp"

#include <array>
#include <string>

namespace souple {
namespace {

struct NamedType {
  std::string_view name;
  NumberType type;
};
using enum NumberKind;
constexpr std::array<NamedType, 15> named_types{{{"float", {real, 4}},
                                                 {"double", {real, 8}},
                                                 {"int", {signed_integer, 4}},
                                                 {"long", {signed_integer, 8}},
                                                 {"vtkidtype", {signed_integer, 4}},
                                                 {"vtktypeint64", {signed_integer, 8}},
                                                 {"vtktypeint32", {signed_integer, 4}},
                                                 {"unsigned_char", {unsigned_integer, 1}},
                                                 {"char", {signed_integer, 1}},
                                                 {"signed_char", {signed_integer, 1}},
                                                 {"short", {signed_integer, 2}},
                                                 {"unsigned_short", {unsigned_integer, 2}},
                                                 {"unsigned_int", {unsigned_integer, 4}},
                                                 {"unsigned_long", {unsigned_integer, 8}},
                                                 {"vtktypeuint64", {unsigned_integer, 8}}}};

}  // namespace

NumberType VtkNumbers::take_type() {
  const std::string name = lower_case(in.word());
  for (const NamedType& known : named_types)
    if (known.name == name) return known.type;
  in.refuse("numbers of type " + quoted(name) + " are not read");
  return {};
}

std::size_t VtkNumbers::take_count(const NumberType& type) { return checked(in.integer(), type); }

std::size_t VtkNumbers::checked(std::int64_t count, const NumberType& type, std::size_t most) {
  return in.checked_count(count, binary ? type.width : 2, most);
}

template <class FromText, class FromBytes>
void VtkNumbers::each(std::size_t count, const NumberType& type, FromText from_text,
                      FromBytes from_bytes) {
  if (!binary) {
    for (std::size_t i = 0; i < count && in.ok(); ++i) from_text();
    return;
  }
  in.end_line();
  const std::string_view bytes = in.take(count * type.width);
  for (std::size_t i = 0; in.ok() && i < count; ++i) from_bytes(bytes.data() + i * type.width);
}

std::vector<std::int64_t> VtkNumbers::take_integers(std::size_t count, const NumberType& type) {
  std::vector<std::int64_t> values;
  values.reserve(count);
  const auto add = [&](std::optional<std::int64_t> value) {
    if (!value) in.fail("a number is not an integer");
    values.push_back(value.value_or(0));
  };
  each(
      count, type, [&] { add(in.integer()); },
      [&](const char* at) { add(load_integer(at, type, true)); });
  if (!in.ok()) values.clear();
  return values;
}

std::vector<double> VtkNumbers::take_reals(std::size_t count, const NumberType& type) {
  std::vector<double> values;
  values.reserve(count);
  each(
      count, type, [&] { values.push_back(in.number()); },
      [&](const char* at) { values.push_back(load_real(at, type, true)); });
  if (!in.ok()) values.clear();
  return values;
}

void VtkNumbers::skip(std::size_t count, const NumberType& type) {
  each(
      count, type, [&] { in.word(); }, [](const char*) {});
}

}  // namespace souple
