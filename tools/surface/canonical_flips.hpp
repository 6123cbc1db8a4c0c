// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL triangulates by way of pointers: of several triangulations that are equally good, the one that
// comes out depends on memory addresses. Flips make it one and the same. Templates, so that no CGAL
// header is needed here.
#pragma once
#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace souple {

/// Makes the triangulation of exactly flat parts of a triangle Surface_mesh the Delaunay one, by
/// Lawson's flips with the exact predicates of Kernel. Of four points on a circle the diagonal from the
/// lexicographically lowest is taken, which is Delaunay for an infinitesimal lift of the points, so
/// that one triangulation remains whatever there was before. Neither the shape nor the vertices change.
template <class Kernel, class Surface>
class CanonicalFlips {
  using Edge = typename Surface::Edge_index;
  using Halfedge = typename Surface::Halfedge_index;
  using Corner = typename Kernel::Point_3;

 public:
  /// Of these edges only, each of two triangles; a flip keeps the number of its edge.
  CanonicalFlips(Surface& surface, std::set<Edge> edges)
      : surface_(surface), edges_(std::move(edges)), pending_(edges_) {}

  void run() {
    while (!pending_.empty()) {
      const Edge e = *pending_.begin();
      pending_.erase(pending_.begin());
      if (wants_flip(e)) flip(surface_.halfedge(e));
    }
  }

 private:
  bool wants_flip(Edge e) const {
    const Halfedge h = surface_.halfedge(e), o = surface_.opposite(h);
    const auto c = surface_.target(surface_.next(h)), d = surface_.target(surface_.next(o));
    return c != d && surface_.halfedge(c, d) == Surface::null_halfedge() &&
           is_better(surface_.point(surface_.source(h)), surface_.point(surface_.target(h)),
                     surface_.point(c), surface_.point(d));
  }

  /// Of the triangles a b c and b a d: whether c d is possible and better than a b.
  static bool is_better(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
    const typename Kernel::Collinear_3 collinear;
    const typename Kernel::Coplanar_orientation_3 side_of_line;  // 1: the last two on the same side
    if (!typename Kernel::Coplanar_3()(a, b, c, d) || collinear(a, b, c) || collinear(a, b, d) ||
        collinear(c, d, a))
      return false;
    const bool is_convex = static_cast<int>(side_of_line(a, b, c, d)) < 0 &&
                           static_cast<int>(side_of_line(c, d, a, b)) < 0;
    if (!is_convex) return false;
    const auto inside =
        static_cast<int>(typename Kernel::Coplanar_side_of_bounded_circle_3()(a, b, c, d));
    return inside != 0 ? inside > 0 : std::min(c, d) < std::min(a, b);
  }

  /// The diagonal a b becomes d c; the four sides may then want to flip.
  void flip(Halfedge h) {
    const Halfedge o = surface_.opposite(h);
    const Halfedge bc = surface_.next(h), ca = surface_.next(bc);
    const Halfedge ad = surface_.next(o), db = surface_.next(ad);
    const auto a = surface_.target(o), b = surface_.target(h);
    const auto c = surface_.target(bc), d = surface_.target(ad);
    const auto f = surface_.face(h), g = surface_.face(o);
    surface_.set_target(h, c);
    surface_.set_target(o, d);
    link({h, ca, ad}, f);
    link({o, db, bc}, g);
    surface_.set_halfedge(a, ca);
    surface_.set_halfedge(b, db);
    surface_.set_halfedge(c, bc);
    surface_.set_halfedge(d, ad);
    for (const Halfedge side : {bc, ca, ad, db})
      if (edges_.contains(surface_.edge(side))) pending_.insert(surface_.edge(side));
  }

  template <class Face>
  void link(const std::array<Halfedge, 3>& loop, Face face) {
    for (std::size_t k = 0; k < 3; ++k) {
      surface_.set_next(loop[k], loop[(k + 1) % 3]);
      surface_.set_face(loop[k], face);
    }
    surface_.set_halfedge(face, loop[0]);
  }

  Surface& surface_;
  std::set<Edge> edges_, pending_;
};

}  // namespace souple
