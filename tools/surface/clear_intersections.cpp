// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/clear_intersections.hpp"

#include <cmath>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/surface/guarded_step.hpp"
#include "tools/surface/pull_apart.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/shells.hpp"

namespace souple {
namespace {

/// Beyond it a local removal takes long and changes the shape.
constexpr std::size_t most_defects = 4000;
constexpr double most_defects_per_triangle = 0.25;
/// Of the volume; a removal that changes more has eaten a part of the shape.
constexpr double most_volume_change = 0.03;

bool is_acceptable(const TriangleMesh& after, const TriangleMesh& before) {
  if (!check_closed_oriented_manifold(after).ok()) return false;
  const double old_volume = signed_volume(before);
  return std::abs(signed_volume(after) - old_volume) <= most_volume_change * std::abs(old_volume);
}

/// Pairs that cut each other, and edges where more than two triangles touch.
std::size_t count_defects(const TriangleMesh& mesh) {
  return find_self_intersections(mesh).pairs.size() + crowded_edge_count(mesh);
}

/// Takes the step's result if it is sound and better.
void attempt(TriangleMesh& mesh, std::size_t& defects, const TriangleMesh& original,
             const std::function<MendStep()>& step) {
  Result<MendStep> done = run_guarded(step);
  if (!done || !is_acceptable(done->mesh, original)) return;
  const std::size_t left = count_defects(done->mesh);
  if (left >= defects) return;
  defects = left;
  mesh = std::move(done->mesh);
}

}  // namespace

TriangleMesh clear_intersections(const TriangleMesh& shell, std::size_t& removed) {
  removed = 0;
  const std::size_t before = count_defects(shell);
  if (before == 0 || before > most_defects ||
      static_cast<double>(before) >
          most_defects_per_triangle * static_cast<double>(shell.triangles.size()))
    return shell;
  TriangleMesh mesh = shell;
  std::size_t defects = before;
  attempt(mesh, defects, shell, [&] { return pull_apart_touching_edges(mesh); });
  if (defects > 0) attempt(mesh, defects, shell, [&] { return remove_intersections(mesh); });
  for (const std::size_t rings : {0, 1, 2, 3, 1, 4})
    if (defects > 0) attempt(mesh, defects, shell, [&] { return cut_out_intersections(mesh, rings); });
  removed = before - defects;
  return mesh;
}

void clear_intersections_of_shells(Mended& mended) {
  std::vector<TriangleMesh> parts;
  std::size_t total = 0;
  for (const Shell& shell : split_into_shells(mended.mesh, {})) {
    std::size_t removed = 0;
    parts.push_back(clear_intersections(shell.mesh, removed));
    total += removed;
  }
  if (total == 0) return;
  mended.mesh = join_meshes(parts);
  mended.actions.push_back(
      {"remove self-intersections", total, "pairs of triangles and touching edges within a shell"});
}

}  // namespace souple
