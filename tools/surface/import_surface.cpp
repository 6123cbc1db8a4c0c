// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/import_surface.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>
#include <string_view>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/child_process.hpp"
#include "tools/surface/clean_soup.hpp"
#include "tools/surface/soup_transfer.hpp"
#include "tools/surface/surface_format.hpp"
#include "tools/surface/surface_readers.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

constexpr double smallest_size_m = 1e-9, largest_size_m = 1e15;
constexpr double longest_time_s = 24 * 3600;
constexpr std::size_t least_memory_bytes = std::size_t{1} << 20;

std::optional<double> metres_per(std::string_view unit) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  static constexpr std::array<Unit, 7> units{{{"m", 1},
                                              {"cm", 1e-2},
                                              {"mm", 1e-3},
                                              {"um", 1e-6},
                                              {"km", 1e3},
                                              {"in", 0.0254},
                                              {"ft", 0.3048}}};
  const auto* found = std::ranges::find(units, unit, &Unit::name);
  return found == units.end() ? std::nullopt : std::optional(found->metres);
}

Status check_options(const ImportOptions& options) {
  const auto bad = [](std::string what) {
    return make_issue(IssueCode::usage_bad_value, std::move(what));
  };
  if (!metres_per(options.unit))
    return bad("unit '" + options.unit.substr(0, 20) + "' is not one of m, cm, mm, um, km, in, ft");
  if (!std::isfinite(options.size_m) || options.size_m < 0)
    return bad("the target size must be positive and finite, in metres");
  if (!(options.time_limit_s > 0) || options.time_limit_s > longest_time_s)
    return bad("the time limit must lie in (0, 86400] s");
  if (options.memory_limit_bytes < least_memory_bytes) return bad("the memory limit is below 1 MiB");
  return {};
}

Issue cannot_open(int error, const std::string& where) {
  const bool is_missing = error == ENOENT || error == ENOTDIR;
  return make_issue(is_missing ? IssueCode::io_file_missing : IssueCode::io_cannot_read,
                    std::strerror(error), where);
}

/// Whole regular files only: a device or pipe could block or never end.
Result<std::string> read_regular_file(const fs::path& file, std::size_t most_bytes) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return cannot_open(errno, file.string());
  struct stat info {};
  std::string bytes;
  std::optional<Issue> issue;
  if (::fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    issue = make_issue(IssueCode::io_cannot_read, "not a regular file", file.string());
  } else if (static_cast<std::uintmax_t>(info.st_size) > most_bytes) {
    issue = make_issue(IssueCode::surface_too_large,
                       std::to_string(info.st_size) + " bytes exceed the memory limit", file.string());
  } else {
    bytes.resize(static_cast<std::size_t>(info.st_size));
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = ::read(fd, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) issue = cannot_open(errno, file.string());
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    bytes.resize(done);
  }
  ::close(fd);
  if (issue) return *issue;
  return bytes;
}

std::string hash_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string hex;
  for (const unsigned char byte : canonical.digest) {
    hex += digits[byte >> 4];
    hex += digits[byte & 15];
  }
  return hex;
}

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
  const double size = longest_side(bounding_box(surface.mesh.vertices));
  if (!(size > 0)) return make_issue(IssueCode::surface_no_extent, "all vertices lie in one point");
  const double scale = options.size_m > 0 ? options.size_m / size : *metres_per(options.unit);
  const double size_m = size * scale;
  if (!(size_m >= smallest_size_m && size_m <= largest_size_m) || !std::isfinite(scale))
    return make_issue(IssueCode::surface_no_extent,
                      "the longest side would be " + std::to_string(size_m) + " m");
  for (Point& p : surface.mesh.vertices) p = scaled(p, scale);
  const Box box = bounding_box(surface.mesh.vertices);
  surface.report.scale = scale;
  surface.report.box_min = box.low;
  surface.report.box_max = box.high;
  return {};
}

Result<ImportedSurface> import_file(const fs::path& file, const ImportOptions& options) {
  const Result<std::string> bytes = read_regular_file(file, options.memory_limit_bytes);
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
  surface.report.file_hash = hash_of(*bytes);
  surface.report.raw_vertex_count = soup->raw_vertex_count;
  surface.report.merged_vertex_count = cleaned.merged_vertex_count;
  surface.report.raw_polygon_count = soup->raw_polygon_count;
  surface.report.dropped_triangle_count = cleaned.dropped_triangle_count + soup->lost_triangle_count;
  if (const Status placed = scale_to_metres(options, surface); !placed) return placed.issue();
  return surface;
}

}  // namespace

Result<ImportedSurface> import_surface(const fs::path& file, const ImportOptions& options) try {
  if (const Status valid = check_options(options); !valid) return valid.issue();
  Result<ImportedSurface> surface = import_file(file, options);
  if (surface || !surface.issue().where.empty()) return surface;
  Issue issue = surface.issue();
  issue.where = file.string();
  return issue;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::surface_too_large, "not enough memory for the surface", file.string());
}

}  // namespace souple
