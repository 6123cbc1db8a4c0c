// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/self_intersections.hpp"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>

#include "tools/surface/clean_soup.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalPoint = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using CgalTriangle = Kernel::Triangle_3;
using BoxOfTriangle = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;

struct CapReached {};

/// Corners of two triangles, those in common first and in the same order.
struct Meeting {
  Triangle a{}, b{};
  std::size_t shared = 0;
};

Meeting meeting_of(const Triangle& a, const Triangle& b) {
  Meeting m{a, b, 0};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = m.shared; j < 3; ++j)
      if (m.a[i] == m.b[j]) {
        std::swap(m.b[j], m.b[m.shared]);
        std::swap(m.a[i], m.a[m.shared]);
        ++m.shared;
        break;
      }
  return m;
}

class Tester {
 public:
  explicit Tester(const TriangleMesh& mesh) {
    points_.reserve(mesh.vertices.size());
    for (const Point& p : mesh.vertices) points_.emplace_back(p[0], p[1], p[2]);
    const std::vector<Index> first = first_at_position(mesh.vertices);
    for (const Triangle& t : mesh.triangles)
      triangles_.push_back({first[at(t[0])], first[at(t[1])], first[at(t[2])]});
  }

  bool is_degenerate(std::size_t t) const {
    const Triangle& v = triangles_[t];
    return CGAL::collinear(point(v[0]), point(v[1]), point(v[2]));
  }
  CGAL::Bbox_3 box(std::size_t t) const {
    const Triangle& v = triangles_[t];
    return point(v[0]).bbox() + point(v[1]).bbox() + point(v[2]).bbox();
  }
  bool cut(std::size_t s, std::size_t t) const {
    const auto [a, b, shared] = meeting_of(triangles_[s], triangles_[t]);
    if (shared == 3) return false;
    if (shared == 2)  // folded onto each other
      return CGAL::coplanar(point(a[0]), point(a[1]), point(a[2]), point(b[2])) &&
             CGAL::coplanar_orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) ==
                 CGAL::POSITIVE;
    if (shared == 1)
      return CGAL::do_intersect(whole(a), Segment(point(b[1]), point(b[2]))) ||
             CGAL::do_intersect(whole(b), Segment(point(a[1]), point(a[2])));
    return CGAL::do_intersect(whole(a), whole(b));
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  const CgalPoint& point(Index i) const { return points_[at(i)]; }
  CgalTriangle whole(const Triangle& t) const { return {point(t[0]), point(t[1]), point(t[2])}; }

  std::vector<CgalPoint> points_;
  std::vector<Triangle> triangles_;
};

}  // namespace

SelfIntersections find_self_intersections(const TriangleMesh& mesh, std::size_t cap) {
  const Tester tester(mesh);
  std::vector<BoxOfTriangle> boxes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!tester.is_degenerate(t)) boxes.emplace_back(tester.box(t), t);
  SelfIntersections found;
  try {
    CGAL::box_self_intersection_d(
        boxes.begin(), boxes.end(), [&](const BoxOfTriangle& a, const BoxOfTriangle& b) {
          if (!tester.cut(a.info(), b.info())) return;
          if (found.pairs.size() >= cap) throw CapReached();
          const auto [low, high] = std::minmax({a.info(), b.info()});
          found.pairs.push_back({static_cast<Index>(low), static_cast<Index>(high)});
        });
  } catch (const CapReached&) {
    found.capped = true;
  }
  std::ranges::sort(found.pairs);
  return found;
}

}  // namespace souple
