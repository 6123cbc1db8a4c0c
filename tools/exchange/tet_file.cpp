// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tet_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>

#include "formats/core/names.hpp"
#include "tools/exchange/tets/mesh_transfer.hpp"
#include "tools/exchange/tets/sort_out_tets.hpp"
#include "tools/exchange/tets/tet_format.hpp"
#include "tools/exchange/tets/tet_readers.hpp"
#include "tools/exchange/tets/text_cursor.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/process/child_answer.hpp"
#include "tools/process/child_process.hpp"
#include "tools/process/import_options.hpp"
#include "tools/process/regular_file.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

constexpr double largest_coordinate = 1e15, smallest_side = 1e-60;  // of the file's numbers

/// The bytes of a file, and of the one that belongs to it.
struct FileBytes {
  TetFormat format{};
  std::string bytes;      ///< of TetGen's .node, otherwise all there is
  std::string ele_bytes;  ///< of TetGen's .ele
};

bool is_node_file(const fs::path& file) { return lower_case(file.extension().string()) == ".node"; }

/// The other of TetGen's two files: in lower case, unless there is one in upper case only.
fs::path partner_of(const fs::path& file) {
  fs::path lower = file, upper = file;
  lower.replace_extension(is_node_file(file) ? ".ele" : ".node");
  upper.replace_extension(is_node_file(file) ? ".ELE" : ".NODE");
  std::error_code ignored;
  return !fs::exists(lower, ignored) && fs::exists(upper, ignored) ? upper : lower;
}

Result<std::string> read_bytes(const fs::path& file, std::size_t limit) {
  Result<std::string> bytes = read_regular_file(file, limit);
  if (bytes || bytes.issue().code != IssueCode::io_file_too_large) return bytes;
  Issue issue = bytes.issue();
  issue.mend = "Allow more memory for reading if the file is sound.";
  return issue;
}

Result<FileBytes> read_files(const fs::path& file, std::size_t limit) {
  Result<std::string> bytes = read_bytes(file, limit);
  if (!bytes) return bytes.issue();
  const Result<TetFormat> format = recognise_tet_format(*bytes, file.extension().string());
  if (!format) return format.issue();
  FileBytes files{*format, std::move(*bytes), {}};
  if (*format != TetFormat::tetgen) return files;
  Result<std::string> other = read_bytes(partner_of(file), limit);
  if (!other) {
    Issue issue = other.issue();
    if (issue.code == IssueCode::io_file_missing)
      issue.mend = "A TetGen mesh is two files, .node and .ele, beside each other.";
    return issue;
  }
  files.ele_bytes = std::move(*other);
  if (!is_node_file(file)) std::swap(files.bytes, files.ele_bytes);
  return files;
}

/// Runs in the child.
Result<RawMesh> parse(const FileBytes& files) {
  const std::string_view bytes = without_utf8_mark(files.bytes);
  switch (files.format) {
    case TetFormat::gmsh:
      return read_gmsh(bytes);
    case TetFormat::medit:
      return read_medit(bytes);
    case TetFormat::vtk:
      return read_vtk(bytes);
    case TetFormat::vtu:
      return read_vtu(bytes);
    case TetFormat::tetgen:
      return read_tetgen(bytes, without_utf8_mark(files.ele_bytes));
    case TetFormat::vega:
      return read_vega(bytes);
  }
  return unsupported("no reader for this format");
}

Result<RawMesh> parse_in_child(const FileBytes& files, const ImportTetsOptions& options) {
  const Result<std::string> sealed = run_in_child(
      [&] {
        const Result<RawMesh> mesh = parse(files);
        return seal_answer(mesh ? Result<std::string>(pack_raw_mesh(*mesh)) : mesh.issue());
      },
      {options.time_limit_s, options.memory_limit_bytes});
  if (!sealed) return sealed.issue();
  const Result<std::string_view> answer = open_answer(*sealed);
  if (!answer) return answer.issue();
  return unpack_raw_mesh(*answer);
}

/// Leaves out the points that no cell uses; keeps the order.
template <class Cell>
std::vector<Point> drop_unused(const std::vector<Point>& points, std::vector<Cell>& cells) {
  std::vector<Index> new_index(points.size(), -1);
  for (const Cell& cell : cells)
    for (const Index i : cell) new_index[static_cast<std::size_t>(i)] = 0;
  std::vector<Point> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (new_index[i] < 0) continue;
    new_index[i] = static_cast<Index>(kept.size());
    kept.push_back(points[i]);
  }
  for (Cell& cell : cells)
    for (Index& i : cell) i = new_index[static_cast<std::size_t>(i)];
  return kept;
}

Status check_extent(const std::vector<Point>& points) {
  for (const Point& p : points)
    for (const double x : p)
      if (std::abs(x) > largest_coordinate)
        return make_issue(IssueCode::tet_no_extent, "a coordinate lies beyond 1e15");
  if (!(longest_side(bounding_box(points)) >= smallest_side))
    return make_issue(IssueCode::tet_no_extent, "all nodes lie in one point");
  return {};
}

Status scale_to_metres(std::vector<Point>& points, const ImportTetsOptions& options, double& scale) {
  const auto found = import_scale(longest_side(bounding_box(points)), options.unit, options.size_m,
                                  IssueCode::tet_no_extent);
  if (!found) return found.issue();
  scale = *found;
  for (Point& p : points)
    for (double& x : p) x *= scale;
  return {};
}

/// 0, 1, … in the order of the file's numbers; named by the file, or by the number.
void set_labels(const std::vector<std::int64_t>& raw, const RawMesh& mesh, ImportedTets& tets) {
  std::map<std::int64_t, Index> index_of;
  for (const std::int64_t label : raw) index_of[label] = 0;
  for (auto& [label, index] : index_of) {
    index = static_cast<Index>(tets.label_names.size());
    const auto named = std::ranges::find_if(mesh.label_names, [&](const auto& name) {
      return name.first == label && is_valid_name(name.second);
    });
    tets.label_names.push_back(named != mesh.label_names.end() ? named->second : std::to_string(label));
  }
  tets.labels.reserve(raw.size());
  for (const std::int64_t label : raw) tets.labels.push_back(index_of[label]);
}

Status take_tets(RawMesh& raw, const ImportTetsOptions& options, ImportedTets& tets) {
  if (const Status checked = check_extent(raw.nodes); !checked) return checked;
  const std::size_t raw_node_count = raw.nodes.size();
  auto sorted =
      sort_out_tets(std::move(raw.nodes), std::move(raw.tets), std::move(raw.labels), options.mend);
  if (!sorted) return sorted.issue();
  set_labels(sorted->labels, raw, tets);
  tets.mesh.tets = std::move(sorted->tets);
  tets.mesh.nodes = drop_unused(sorted->nodes, tets.mesh.tets);
  tets.report.turned_count = sorted->turned_count;
  tets.report.dropped_count = sorted->dropped_count;
  tets.report.split_node_count = sorted->split_node_count;
  tets.report.unused_node_count = raw_node_count + sorted->split_node_count - tets.mesh.nodes.size();
  tets.report.other_element_count += raw.triangles.size();
  return scale_to_metres(tets.mesh.nodes, options, tets.report.scale);
}

Status take_triangles(RawMesh& raw, const ImportTetsOptions& options, ImportedTets& tets) {
  if (raw.triangles.empty() || raw.volume_cell_count > 0)
    return make_issue(IssueCode::tet_file_no_tets,
                      std::to_string(raw.volume_cell_count) + " cells are volumes of another kind, " +
                          std::to_string(raw.triangles.size()) + " are triangles");
  tets.triangles.triangles = std::move(raw.triangles);
  tets.triangles.vertices = drop_unused(raw.nodes, tets.triangles.triangles);
  tets.report.unused_node_count = raw.nodes.size() - tets.triangles.vertices.size();
  if (const Status checked = check_extent(tets.triangles.vertices); !checked) return checked;
  return scale_to_metres(tets.triangles.vertices, options, tets.report.scale);
}

Result<ImportedTets> import_files(const fs::path& file, const ImportTetsOptions& options) {
  const Result<FileBytes> files = read_files(file, options.memory_limit_bytes);
  if (!files) return files.issue();
  Result<RawMesh> raw = parse_in_child(*files, options);
  if (!raw) return raw.issue();
  ImportedTets tets;
  tets.report.format = raw->format;
  tets.report.file_bytes = files->bytes.size() + files->ele_bytes.size();
  tets.report.file_hash = hash_text(files->bytes + files->ele_bytes);
  tets.report.raw_node_count = raw->nodes.size();
  tets.report.raw_tet_count = raw->tets.size();
  tets.report.other_element_count = raw->other_cell_count + raw->volume_cell_count;
  tets.report.linearised_count = raw->linearised_count;
  const bool has_tets = !raw->tets.empty();
  const Status taken = has_tets ? take_tets(*raw, options, tets) : take_triangles(*raw, options, tets);
  if (!taken) return taken.issue();
  return tets;
}

}  // namespace

Result<ImportedTets> import_tets(const fs::path& file, const ImportTetsOptions& options) try {
  const Status valid = check_import_options(options.unit, options.size_m, options.time_limit_s,
                                            options.memory_limit_bytes);
  if (!valid) return valid.issue();
  Result<ImportedTets> tets = import_files(file, options);
  if (tets || !tets.issue().where.empty()) return tets;
  Issue issue = tets.issue();
  issue.where = file.string();
  return issue;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::surface_reader_memory, "not enough memory for the mesh", file.string());
}

}  // namespace souple
