// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "tools/exchange/tets/vtk_cells.hpp"
#include "tools/exchange/tets/vtk_numbers.hpp"

namespace souple {

/// Legacy VTK's data of points and cells: skipped, but for the labels of the cells.
class VtkAttributes {
 public:
  explicit VtkAttributes(VtkNumbers& numbers) : numbers_(numbers), in_(numbers.in) {}

  /// The section behind the keyword (lower case); an unknown one fails.
  void read(const std::string& keyword);
  const std::vector<std::int64_t>& labels() const { return labels_.values; }

 private:
  void begin(bool of_cells);
  void read_field();
  void read_scalars();
  void read_array(const std::string& name, std::size_t width, std::size_t length,
                  const NumberType& type);
  void skip_named(std::size_t width);
  void skip_texture();
  void skip_colours();
  void skip_colour_table();
  void skip_metadata();
  void skip_rows(std::size_t row_count, std::size_t width, const NumberType& type);

  VtkNumbers& numbers_;
  TextCursor& in_;
  VtkLabels labels_;
  std::size_t row_count_ = 0;
  bool of_cells_ = false;
};

}  // namespace souple
