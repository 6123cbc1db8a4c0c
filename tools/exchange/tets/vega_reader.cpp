// SPDX-License-Identifier: GPL-3.0-or-later
// Vega FEM's .veg (Vega FEM user's manual, "Volumetric mesh file format").
#include <map>
#include <string>

#include "formats/core/limits.hpp"
#include "tools/exchange/tets/tet_readers.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

class VegaReader {
 public:
  explicit VegaReader(std::string_view bytes)
      : in_(bytes, {.hash_comments = true, .comma_is_blank = true}) {}

  Result<RawMesh> read() {
    if (!in_.peek().starts_with('*'))
      return malformed("the file begins with " + quoted(in_.peek()) + " instead of *VERTICES");
    while (!in_.at_end()) read_section(lower_case(in_.word()));
    if (in_.ok() && !has_vertices_) in_.fail("the file has no *VERTICES");
    if (!in_.ok()) return in_.issue();
    mesh_.format = "vega";
    if (region_count_ == 0) mesh_.labels.clear();
    return std::move(mesh_);
  }

 private:
  void read_section(const std::string& keyword) {
    if (keyword == "*vertices") return read_vertices();
    if (keyword == "*elements") return read_elements();
    if (keyword == "*set") return read_set();
    if (keyword == "*region") return read_region();
    if (keyword == "*material") return skip_section();
    if (keyword.starts_with("*include")) return in_.refuse("files that include others are not read");
    in_.fail("found " + quoted(keyword) + " where a section should begin");
  }

  bool is_section_over() { return in_.at_end() || in_.peek().starts_with('*'); }

  void skip_section() {
    while (!is_section_over()) in_.word();
  }

  /// Rows and columns of what follows; two further numbers count attributes and markers, always 0.
  std::size_t take_size(std::int64_t columns, std::size_t most) {
    const std::size_t count = in_.count(2 * static_cast<std::size_t>(columns + 1), most);
    if (in_.integer() != columns)
      in_.refuse("only rows of " + std::to_string(columns) + " numbers are read");
    return count;
  }

  void read_vertices() {
    if (has_vertices_) return in_.fail("a second section of vertices");
    has_vertices_ = true;
    const std::size_t count = take_size(3, largest_node_count);
    if (in_.integer() != 0 || in_.integer() != 0) in_.refuse("vertices with attributes are not read");
    mesh_.nodes.reserve(count);
    for (std::size_t i = 0; i < count && in_.ok(); ++i) {
      const std::int64_t number = in_.integer();
      if (i == 0) first_ = number;
      if (number != first_ + static_cast<std::int64_t>(i) || first_ < 0 || first_ > 1)
        in_.fail("vertex " + std::to_string(number) +
                 " is out of order: they are numbered from 0 or 1");
      const double x = in_.number(), y = in_.number(), z = in_.number();
      mesh_.nodes.push_back({x, y, z});
    }
  }

  void read_elements() {
    const std::string kind = lower_case(in_.word());
    if (kind != "tet" && kind != "tets")
      return in_.refuse("elements of kind " + quoted(kind) + " are not read");
    if (!has_vertices_) return in_.fail("the elements stand before the vertices");
    if (!mesh_.tets.empty()) return in_.fail("a second section of elements");
    const std::size_t count = take_size(4, largest_cell_count);
    in_.integer();
    std::vector<Index> nodes;
    for (std::size_t i = 0; i < count && in_.ok(); ++i) {
      in_.integer();  // its own number
      nodes.clear();
      for (int k = 0; k < 4; ++k) nodes.push_back(take_index(mesh_.nodes.size(), "vertex"));
      if (in_.ok()) add_cell(mesh_, {CellKind::tet, 4}, nodes);
    }
    mesh_.labels.assign(mesh_.tets.size(), 0);
  }

  Index take_index(std::size_t count, const char* what) {
    const std::int64_t number = in_.integer();
    if (in_.ok() && (number < first_ || static_cast<std::uint64_t>(number - first_) >= count))
      in_.fail(std::string(what) + " " + std::to_string(number) + " is not there");
    return static_cast<Index>(number - first_);
  }

  void read_set() {
    std::vector<Index>& elements = sets_[std::string(in_.word())];
    while (!is_section_over()) elements.push_back(take_index(mesh_.tets.size(), "element"));
  }

  /// Set of elements and name of a material; labels count the regions.
  void read_region() {
    const std::string set(in_.word());
    // Every region may name every element: a bound keeps the work linear.
    if (++region_count_ > most_regions_) in_.refuse("more than 256 regions");
    mesh_.label_names.emplace_back(region_count_, in_.word());
    if (set == "allElements") {
      mesh_.labels.assign(mesh_.tets.size(), region_count_);
      return;
    }
    const auto found = sets_.find(set);
    if (found == sets_.end()) return in_.fail("the set " + quoted(set) + " is not there");
    for (const Index element : found->second)
      mesh_.labels[static_cast<std::size_t>(element)] = region_count_;
  }

  static constexpr std::int64_t most_regions_ = limits::regions;
  TextCursor in_;
  RawMesh mesh_;
  std::map<std::string, std::vector<Index>> sets_;
  std::int64_t first_ = 1;
  std::int64_t region_count_ = 0;
  bool has_vertices_ = false;
};

}  // namespace

Result<RawMesh> read_vega(std::string_view bytes) { return VegaReader(bytes).read(); }

}  // namespace souple
