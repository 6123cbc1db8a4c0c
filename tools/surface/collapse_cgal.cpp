// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <utility>

#include "tools/surface/collapse.hpp"
#include "tools/surface/surface_conversion.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace sms = CGAL::Surface_mesh_simplification;

/// First without turning any triangle over, then as far as it must.
template <class Cost, class Placement>
void collapse(Surface& surface, std::size_t faces, const Cost& cost, const Placement& placement) {
  // A closed triangle mesh has 3/2 edges a face; the predicate stops below its number.
  const sms::Count_stop_predicate<Surface> stop(faces * 3 / 2 + 1);
  sms::edge_collapse(surface, stop,
                     CGAL::parameters::get_cost(cost).get_placement(placement).filter(
                         sms::Bounded_normal_change_filter<>()));
  if (surface.number_of_faces() > faces)
    sms::edge_collapse(surface, stop, CGAL::parameters::get_cost(cost).get_placement(placement));
}

}  // namespace

MendStep collapse_edges(const TriangleMesh& mesh, std::size_t faces, CollapseRule rule) {
  Surface surface = to_surface<Surface>(mesh);
  if (rule == CollapseRule::lindstrom_turk) {
    collapse(surface, faces, sms::LindstromTurk_cost<Surface>(),
             sms::LindstromTurk_placement<Surface>());
  } else {
    sms::GarlandHeckbert_plane_policies<Surface, Kernel> policies(surface);
    collapse(surface, faces, policies.get_cost(), policies.get_placement());
  }
  TriangleMesh less = to_plain(surface);
  const std::size_t removed = mesh.triangles.size() - less.triangles.size();
  return {std::move(less), removed};
}

}  // namespace souple
