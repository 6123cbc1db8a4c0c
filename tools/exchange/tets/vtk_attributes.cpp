// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/vtk_attributes.hpp"

namespace souple {
namespace {

constexpr NumberType byte{NumberKind::unsigned_integer, 1};
constexpr std::size_t most_components = 1000;

}  // namespace

void VtkAttributes::read(const std::string& keyword) {
  if (keyword == "cell_data" || keyword == "point_data") return begin(keyword == "cell_data");
  if (keyword == "metadata") return skip_metadata();
  if (keyword == "field") return read_field();
  if (keyword == "scalars") return read_scalars();
  if (keyword == "color_scalars") return skip_colours();
  if (keyword == "lookup_table") return skip_colour_table();
  if (keyword == "texture_coordinates") return skip_texture();
  if (keyword == "vectors" || keyword == "normals") return skip_named(3);
  if (keyword == "tensors") return skip_named(9);
  if (keyword == "tensors6") return skip_named(6);
  if (keyword == "global_ids" || keyword == "pedigree_ids") return skip_named(1);
  in_.fail("found " + quoted(keyword) + " where a keyword should stand");
}

void VtkAttributes::begin(bool of_cells) {
  of_cells_ = of_cells;
  row_count_ = in_.count(0, VtkNumbers::most_values);
}

/// Arrays with their own sizes; before the points it describes the whole file.
void VtkAttributes::read_field() {
  in_.word();  // its name
  const std::size_t count = in_.count(1, VtkNumbers::most_values);
  for (std::size_t i = 0; i < count && in_.ok(); ++i) {
    while (in_.peek() == "METADATA") skip_metadata();
    const std::string name(in_.word());
    const std::size_t width = in_.count(0, most_components);
    const std::size_t length = in_.count(0, VtkNumbers::most_values);
    const NumberType type = numbers_.take_type();
    read_array(name, width, length, type);
  }
}

void VtkAttributes::read_scalars() {
  const std::string name(in_.word());
  const NumberType type = numbers_.take_type();
  std::size_t width = 1;
  if (lower_case(in_.peek()) != "lookup_table") width = in_.count(0, most_components);
  if (lower_case(in_.word()) != "lookup_table") in_.fail("the word LOOKUP_TABLE is missing");
  in_.word();  // the table's name
  read_array(name, width, row_count_, type);
}

void VtkAttributes::read_array(const std::string& name, std::size_t width, std::size_t length,
                               const NumberType& type) {
  const auto rank = of_cells_ && width == 1 ? label_rank(name) : std::nullopt;
  if (!rank) return skip_rows(length, width, type);
  std::vector<std::int64_t> values;
  const std::size_t count = numbers_.checked(static_cast<std::int64_t>(length), type);
  values.reserve(count);
  for (const double value : numbers_.take_reals(count, type))
    if (const auto whole = exact_integer(value)) values.push_back(*whole);
  if (values.size() == length) labels_.offer(*rank, std::move(values));
}

void VtkAttributes::skip_rows(std::size_t row_count, std::size_t width, const NumberType& type) {
  // At most 2^40 rows of 1000: no overflow.
  numbers_.skip(numbers_.checked(static_cast<std::int64_t>(row_count * width), type), type);
}

void VtkAttributes::skip_named(std::size_t width) {
  in_.word();  // name
  const NumberType type = numbers_.take_type();
  skip_rows(row_count_, width, type);
}

void VtkAttributes::skip_texture() {
  in_.word();  // name
  const std::size_t width = in_.count(0, 3);
  const NumberType type = numbers_.take_type();
  skip_rows(row_count_, width, type);
}

// Colours are bytes in a binary file and fractions in a text.
void VtkAttributes::skip_colours() {
  in_.word();  // name
  const std::size_t width = in_.count(0, most_components);
  skip_rows(row_count_, width, byte);
}

void VtkAttributes::skip_colour_table() {
  in_.word();  // name
  const std::size_t colour_count = numbers_.take_count(byte);
  skip_rows(colour_count, 4, byte);
}

/// Up to an empty line.
void VtkAttributes::skip_metadata() {
  in_.rest_of_line();
  while (in_.ok() && in_.left() > 0)
    if (in_.rest_of_line().find_first_not_of(" \t") == std::string_view::npos) return;
}

}  // namespace souple
