// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>

#include "tools/surface/obj_text.hpp"
#include "tools/surface/ply_text.hpp"
#include "tools/surface/surface_readers.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalPoints = std::vector<Kernel::Point_3>;
using OnePolygon = CGAL::Surface_mesh<Kernel::Point_3>;

/// The second triangulator's effort grows with the cube of the corners.
constexpr std::size_t most_corners_of_cover = 300;

/// Why a text reader gave up: a number that is not finite, or something else.
Issue diagnose(std::string_view text, std::string_view format) {
  std::size_t start = 0;
  while ((start = text.find_first_not_of(" \t\r\n", start)) != text.npos) {
    const std::size_t end = std::min(text.size(), text.find_first_of(" \t\r\n", start));
    std::string_view word = text.substr(start, end - start);
    start = end;
    double value = 0;
    const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_number = parsed.ptr == word.data() + word.size();
    if (is_number && (parsed.ec == std::errc::result_out_of_range ||
                      (parsed.ec == std::errc{} && !std::isfinite(value))))
      return make_issue(IssueCode::surface_not_finite,
                        "the file holds the number '" + std::string(word.substr(0, 40)) + "'");
  }
  return make_issue(IssueCode::surface_malformed,
                    "not readable as " + std::string(format) + ": truncated or against its rules");
}

void append_points(const CgalPoints& from, PolygonSoup& soup) {
  for (const auto& p : from) soup.points.push_back({p.x(), p.y(), p.z()});
}

Result<PolygonSoup> read_obj(std::string_view bytes) {
  const Result<std::string> plain = plain_obj_text(bytes);
  if (!plain) return plain.issue();
  std::istringstream in(*plain);
  CgalPoints points;
  PolygonSoup soup;
  if (!CGAL::IO::read_OBJ(in, points, soup.polygons) && !points.empty() && !soup.polygons.empty())
    return make_issue(IssueCode::surface_malformed, "not readable as obj");
  append_points(points, soup);
  return soup;
}

/// As CGAL::IO::read_OFF over the same scanner, but trusting none of the declared counts and telling a
/// wrong index from a truncated file.
Result<PolygonSoup> read_off(std::string_view bytes) {
  const std::string_view text = without_byte_order_mark(bytes);
  std::istringstream in{std::string(text)};
  CGAL::File_scanner_OFF scanner(in);
  PolygonSoup soup;
  if (!in) return diagnose(text, "off");
  for (std::size_t i = 0; i < scanner.size_of_vertices(); ++i) {
    double x = 0, y = 0, z = 0, w = 1, n = 0;
    scanner.scan_vertex(x, y, z, w);
    if (scanner.binary() && scanner.has_normals()) scanner.scan_normal(n, n, n, n);
    if (in.fail()) return diagnose(text, "off");
    soup.points.push_back({x / w, y / w, z / w});
  }
  for (std::size_t i = 0; i < scanner.size_of_facets(); ++i) {
    std::size_t corners = 0;
    scanner.scan_facet(corners, i);
    if (in.fail()) return diagnose(text, "off");
    Polygon& polygon = soup.polygons.emplace_back();
    for (std::size_t k = 0; k < corners; ++k) {
      std::size_t index = 0;
      scanner.scan_facet_vertex_index(index, k + 1, i);
      if (in.rdstate() == std::ios::failbit)  // that alone; a missing number sets the bad bit
        return make_issue(IssueCode::surface_bad_index,
                          "face " + std::to_string(i) + " names a vertex outside the " +
                              std::to_string(soup.points.size()) + " of the file");
      if (in.fail()) return diagnose(text, "off");
      polygon.push_back(index);
    }
    if (scanner.binary() && scanner.has_colors()) {
      unsigned char r = 0, g = 0, b = 0;
      scanner.scan_color(r, g, b);
    }
  }
  return soup;
}

bool scan_ply(std::string text, PolygonSoup& soup) {
  std::istringstream in(std::move(text));
  CgalPoints points;
  if (!CGAL::IO::read_PLY(in, points, soup.polygons)) return false;
  append_points(points, soup);
  return true;
}

Result<PolygonSoup> read_ply(std::string_view bytes) {
  PolygonSoup soup;
  if (scan_ply(std::string(without_byte_order_mark(bytes)), soup)) return soup;
  const auto plain = plain_ply_text(without_byte_order_mark(bytes));
  soup = {};
  if (plain && scan_ply(*plain, soup)) return soup;
  return diagnose(bytes, "ply");
}

/// CGAL merges corners through an ordered map, in which a NaN would equal anything and vanish.
bool binary_stl_is_finite(std::string_view bytes) {
  for (std::size_t record = 84; record + 50 <= bytes.size(); record += 50)
    for (std::size_t k = 3; k < 12; ++k) {
      float x = 0;
      std::memcpy(&x, bytes.data() + record + 4 * k, sizeof x);
      if (!std::isfinite(x)) return false;
    }
  return true;
}

/// CGAL guesses the kind of STL by the letters "solid " and keeps what a wrong guess had read already;
/// the text is brought into, a binary header out of, that form first.
Result<PolygonSoup> read_stl(std::string_view bytes) {
  const bool is_binary = bytes.find('\0') != bytes.npos;
  std::string text(is_binary ? bytes : without_byte_order_mark(bytes));
  if (is_binary) {
    if (!binary_stl_is_finite(bytes))
      return make_issue(IssueCode::surface_not_finite,
                        "a corner has a coordinate that is NaN or infinite");
    text.front() = 'x';
  } else {
    std::ranges::transform(text, text.begin(), [](unsigned char c) {
      return c == '\t' ? ' ' : static_cast<char>(std::tolower(c));
    });
  }
  std::istringstream in(text);
  CgalPoints points;
  PolygonSoup soup;
  if (!CGAL::IO::read_STL(in, points, soup.polygons)) return diagnose(is_binary ? "" : text, "stl");
  append_points(points, soup);
  return soup;
}

/// Appends the triangles of one polygon; false if neither triangulator covers it.
bool split_polygon(const Polygon& polygon, const std::vector<Point>& points,
                   std::vector<Triangle>& triangles) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  OnePolygon mesh;
  std::vector<OnePolygon::Vertex_index> corners;
  for (const std::size_t v : polygon)
    corners.push_back(mesh.add_vertex({points[v][0], points[v][1], points[v][2]}));
  const auto face = mesh.add_face(corners);
  const auto use_cdt = [](bool yes) { return CGAL::parameters::use_delaunay_triangulation(yes); };
  if (!pmp::triangulate_face(face, mesh, use_cdt(true)) &&
      (polygon.size() > most_corners_of_cover || !pmp::triangulate_face(face, mesh, use_cdt(false))))
    return false;
  for (const auto f : mesh.faces()) {
    Triangle& triangle = triangles.emplace_back();
    std::size_t k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      if (k < 3) triangle[k++] = static_cast<Index>(polygon[static_cast<std::size_t>(v.idx())]);
  }
  return true;
}

/// Corners at the same place as the one before say nothing about the shape and upset the triangulators.
Polygon without_repeated_corners(const Polygon& polygon, const std::vector<Point>& points) {
  Polygon corners;
  for (const std::size_t v : polygon)
    if (corners.empty() || points[v] != points[corners.back()]) corners.push_back(v);
  while (corners.size() > 1 && points[corners.front()] == points[corners.back()]) corners.pop_back();
  return corners;
}

}  // namespace

Result<PolygonSoup> read_with_cgal(SurfaceFormat format, std::string_view bytes) {
  switch (format) {
    case SurfaceFormat::obj:
      return read_obj(bytes);
    case SurfaceFormat::off:
      return read_off(bytes);
    case SurfaceFormat::ply:
      return read_ply(bytes);
    default:
      return read_stl(bytes);
  }
}

TriangleSoup triangulate_polygons(PolygonSoup soup) {
  TriangleSoup out;
  out.raw_vertex_count = soup.points.size();
  out.raw_polygon_count = soup.polygons.size();
  for (const Polygon& polygon : soup.polygons) {
    const Polygon corners =
        polygon.size() > 3 ? without_repeated_corners(polygon, soup.points) : polygon;
    if (corners.size() == 3)
      out.mesh.triangles.push_back({static_cast<Index>(corners[0]), static_cast<Index>(corners[1]),
                                    static_cast<Index>(corners[2])});
    else if (polygon.size() > 3 &&
             (corners.size() < 3 || !split_polygon(corners, soup.points, out.mesh.triangles)))
      out.lost_triangle_count += polygon.size() - 2;
  }
  out.mesh.vertices = std::move(soup.points);
  return out;
}

}  // namespace souple
