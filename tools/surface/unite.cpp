// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/unite.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/unit_frame.hpp"
#include "tools/surface/clear_intersections.hpp"
#include "tools/surface/guarded_step.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/shells.hpp"

namespace souple {
namespace {

constexpr std::size_t most_united = 200;

TriangleMesh outward(TriangleMesh mesh) {
  if (signed_volume(mesh) < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Between the largest part and the sum of all.
bool has_plausible_volume(const TriangleMesh& united, const std::vector<TriangleMesh>& parts) {
  double largest = 0, sum = 0;
  for (const TriangleMesh& part : parts) {
    const double volume = signed_volume(part);
    largest = std::max(largest, volume);
    sum += volume;
  }
  const double volume = signed_volume(united);
  return volume > 0.99 * largest && volume < 1.01 * sum;
}

std::optional<TriangleMesh> united(const std::vector<TriangleMesh>& parts) {
  Result<MendStep> step = run_guarded([&] { return unite_shells(parts); });
  if (!step || !check_closed_oriented_manifold(step->mesh).ok() ||
      !has_plausible_volume(step->mesh, parts))
    return std::nullopt;
  for (Point& p : step->mesh.vertices) p = on_unit_grid(p);
  step->mesh = in_canonical_order(step->mesh);
  std::size_t removed = 0;  // the rounding may have folded triangles over
  return clear_intersections(step->mesh, removed);
}

}  // namespace

void unite_crossing_shells(Mended& mended) {
  const SelfIntersections cuts = find_self_intersections(mended.mesh);
  const auto groups = groups_of_crossing_shells(mended.mesh, cuts.pairs);
  std::vector<Shell> shells = split_into_shells(mended.mesh, {});
  if (groups.size() == shells.size()) return;
  std::vector<TriangleMesh> result;
  std::size_t count = 0;
  for (const std::vector<std::size_t>& group : groups) {
    std::vector<TriangleMesh> parts;
    for (const std::size_t s : group) parts.push_back(std::move(shells[s].mesh));
    std::optional<TriangleMesh> whole;
    if (parts.size() > 1 && parts.size() <= most_united) {
      std::ranges::transform(parts, parts.begin(),
                             [](TriangleMesh& m) { return outward(std::move(m)); });
      whole = united(parts);
    }
    if (whole) count += parts.size();
    result.push_back(whole ? std::move(*whole) : join_meshes(parts));
  }
  if (count == 0) return;
  mended.mesh = join_meshes(result);
  mended.actions.push_back({"union", count, "shells that crossed united"});
}

}  // namespace souple
