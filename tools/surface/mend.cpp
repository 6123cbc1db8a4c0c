// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/mend.hpp"

#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/surface/clear_intersections.hpp"
#include "tools/surface/close_surface.hpp"
#include "tools/surface/pull_apart.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/unite.hpp"

namespace souple {
namespace {

bool is_sound(const TriangleMesh& mesh) { return check_closed_oriented_manifold(mesh).ok(); }

void pull_apart(Mended& mended) {
  MendStep apart = pull_apart_touching_edges(mended.mesh);
  if (apart.count > 0) {
    mended.mesh = std::move(apart.mesh);
    mended.actions.push_back({"pull apart", apart.count, "vertices where parts touched along an edge"});
  }
}

void settle(Mended& mended) {
  mended.closed = is_sound(mended.mesh);
  if (!mended.closed) {
    mended.failure = check_closed_oriented_manifold(mended.mesh).issue();
    return;
  }
  const SelfIntersections cuts = find_self_intersections(mended.mesh);
  mended.cuts = cuts.pairs.size();
  if (mended.cuts > 0)
    mended.failure =
        make_issue(IssueCode::surface_shells_cross,
                   std::to_string(mended.cuts) + " pairs of triangles still cut each other");
}

}  // namespace

Mended mend_surface(const TriangleMesh& unit) {
  Mended mended;
  mended.mesh = unit;
  close_surface(mended);
  if (mended.failure) return mended;
  if (!is_sound(mended.mesh)) {
    settle(mended);
    return mended;
  }
  clear_intersections_of_shells(mended);
  unite_crossing_shells(mended);
  pull_apart(mended);
  settle(mended);
  return mended;
}

}  // namespace souple
