// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/import_surface.hpp"

#include <new>
#include <string_view>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/process/child_process.hpp"
#include "tools/process/import_options.hpp"
#include "tools/process/regular_file.hpp"
#include "tools/surface/clean_soup.hpp"
#include "tools/surface/soup_transfer.hpp"
#include "tools/surface/surface_format.hpp"
#include "tools/surface/surface_readers.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

/// Runs in the child.
Result<TriangleSoup> parse(SurfaceFormat format, std::string_view bytes, const fs::path& file) {
  const bool is_plain = format == SurfaceFormat::obj || format == SurfaceFormat::off ||
                        format == SurfaceFormat::ply || format == SurfaceFormat::stl;
  Result<PolygonSoup> soup =
      is_plain ? read_with_cgal(format, bytes) : read_with_assimp(format, bytes, file);
  if (!soup) return soup.issue();
  if (const Status checked = check_polygon_soup(*soup); !checked) return checked.issue();
  TriangleSoup triangles = triangulate_polygons(std::move(*soup));
  // An STL stores three vertices a triangle; its reader has merged them.
  if (format == SurfaceFormat::stl) triangles.raw_vertex_count = 3 * triangles.raw_polygon_count;
  return triangles;
}

Status scale_to_metres(const ImportOptions& options, ImportedSurface& surface) {
  const auto scale = import_scale(longest_side(bounding_box(surface.mesh.vertices)), options.unit,
                                  options.size_m, IssueCode::surface_no_extent);
  if (!scale) return scale.issue();
  for (Point& p : surface.mesh.vertices) p = scaled(p, *scale);
  const Box box = bounding_box(surface.mesh.vertices);
  surface.report.scale = *scale;
  surface.report.box_min = box.low;
  surface.report.box_max = box.high;
  return {};
}

Result<ImportedSurface> import_file(const fs::path& file, const ImportOptions& options) {
  const Result<std::string> bytes =
      read_regular_file(file, options.memory_limit_bytes, IssueCode::surface_too_large);
  if (!bytes) return bytes.issue();
  const Result<SurfaceFormat> format = recognise_surface_format(*bytes, file.extension().string());
  if (!format) return format.issue();
  const Result<std::string> answer =
      run_in_child([&] { return pack_answer(parse(*format, *bytes, file)); },
                   {options.time_limit_s, options.memory_limit_bytes});
  if (!answer) return answer.issue();
  const Result<TriangleSoup> soup = unpack_answer(*answer);
  if (!soup) return soup.issue();

  CleanedSoup cleaned = clean_soup(soup->mesh);
  if (cleaned.mesh.triangles.empty()) {
    if (!(longest_side(bounding_box(soup->mesh.vertices)) > 0))
      return make_issue(IssueCode::surface_no_extent, "all vertices lie in one point");
    return make_issue(IssueCode::surface_no_triangles, "every polygon of the file is degenerate");
  }
  ImportedSurface surface;
  surface.mesh = std::move(cleaned.mesh);
  surface.report.format = surface_format_name(*format);
  surface.report.file_bytes = bytes->size();
  surface.report.file_hash = hash_text(*bytes);
  surface.report.raw_vertex_count = soup->raw_vertex_count;
  surface.report.merged_vertex_count = cleaned.merged_vertex_count;
  surface.report.raw_polygon_count = soup->raw_polygon_count;
  surface.report.dropped_triangle_count = cleaned.dropped_triangle_count + soup->lost_triangle_count;
  if (const Status placed = scale_to_metres(options, surface); !placed) return placed.issue();
  return surface;
}

}  // namespace

Result<ImportedSurface> import_surface(const fs::path& file, const ImportOptions& options) try {
  const Status valid = check_import_options(options.unit, options.size_m, options.time_limit_s,
                                            options.memory_limit_bytes);
  if (!valid) return valid.issue();
  Result<ImportedSurface> surface = import_file(file, options);
  if (surface || !surface.issue().where.empty()) return surface;
  Issue issue = surface.issue();
  issue.where = file.string();
  return issue;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::surface_too_large, "not enough memory for the surface", file.string());
}

}  // namespace souple
