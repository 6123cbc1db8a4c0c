// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <set>

#include "tools/surface/canonical_flips.hpp"
#include "tools/surface/mend_steps.hpp"
#include "tools/surface/surface_conversion.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

void make_canonical(Surface& surface) {
  const std::set<Surface::Edge_index> all(surface.edges().begin(), surface.edges().end());
  CanonicalFlips<Kernel, Surface>(surface, all).run();
}

}  // namespace

MendStep unite_shells(const std::vector<TriangleMesh>& shells) {
  Surface all;
  std::size_t united = 0;
  for (const TriangleMesh& shell : shells) {
    Surface next = to_surface<Surface>(shell);
    if (united++ == 0) {
      all = std::move(next);
      continue;
    }
    Surface both;
    const auto throws = CGAL::parameters::throw_on_self_intersection(true);
    if (!pmp::corefine_and_compute_union(all, next, both, throws)) return {};
    both.collect_garbage();
    // Otherwise the next union would carry the differences into its vertices.
    make_canonical(both);
    all = std::move(both);
  }
  return {to_plain(all, [](const Kernel::FT& x) { return CGAL::to_double(CGAL::exact(x)); }), united};
}

}  // namespace souple
