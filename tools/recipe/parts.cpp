// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/parts.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>

#include "tools/exchange/nearest_name.hpp"
#include "tools/geometry/signed_distance.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/recipe/node_selection.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/repair.hpp"

namespace souple {
namespace {

using Contains = std::function<bool(const Point&)>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

bool is_inside(const BoxSelection& box, const Point& x) {
  for (std::size_t i = 0; i < 3; ++i)
    if (x[i] < box.min[i] || x[i] > box.max[i]) return false;
  return true;
}

bool is_inside(const SphereSelection& sphere, const Point& x) {
  return norm(subtract(x, sphere.centre)) <= sphere.radius_m;
}

/// A file beside the main one, at the same scale.
Result<TriangleMesh> read_part(const FileSelection& part, double scale, std::string& hashes) {
  auto imported = import_surface(part.file, {});
  if (!imported) return imported.issue();
  hashes += imported->report.file_hash;
  for (Point& p : imported->mesh.vertices) p = scaled(p, scale);
  return std::move(imported->mesh);
}

/// The triangles of `surface` with a corner in the selection.
template <class Selection>
TriangleMesh piece_of(const TriangleMesh& surface, const Selection& selection) {
  TriangleMesh piece{surface.vertices, {}};
  for (const Triangle& t : surface.triangles)
    if (std::ranges::any_of(t, [&](Index i) { return is_inside(selection, surface.vertices[at(i)]); }))
      piece.triangles.push_back(t);
  return piece;
}

std::string where_region(const std::string& name) { return "[[material.region]] " + name; }
std::string where_refine(std::size_t number) { return "[[mesh.refine]] " + std::to_string(number + 1); }

/// The region of one request, or a patch without triangles if it holds none of the surface.
Result<LocalSize> local_size(const RefineRequest& request, const TriangleMesh& surface, double scale,
                             std::string& hashes) {
  LocalSize size;
  size.edge_length_m = request.edge_length_m;
  if (const auto* file = std::get_if<FileSelection>(&request.where)) {
    auto patch = read_part(*file, scale, hashes);
    if (!patch) return patch.issue();
    size.region = PatchRegion{std::move(*patch), request.distance_m};
  } else if (const auto* box = std::get_if<BoxSelection>(&request.where)) {
    if (request.distance_m > 0)
      size.region = PatchRegion{piece_of(surface, *box), request.distance_m};
    else
      size.region = BoxRegion{box->min, box->max};
  } else {
    const auto& sphere = std::get<SphereSelection>(request.where);
    if (request.distance_m > 0)
      size.region = PatchRegion{piece_of(surface, sphere), request.distance_m};
    else
      size.region = BallRegion{sphere.centre, sphere.radius_m};
  }
  return size;
}

Result<Contains> containment(const RegionRequest& request, double scale, std::string& hashes) {
  if (const auto* box = std::get_if<BoxSelection>(&request.where))
    return Contains([box = *box](const Point& p) { return is_inside(box, p); });
  if (const auto* sphere = std::get_if<SphereSelection>(&request.where))
    return Contains([sphere = *sphere](const Point& p) { return is_inside(sphere, p); });
  auto part = read_part(std::get<FileSelection>(request.where), scale, hashes);
  if (!part) return part.issue();
  const auto closed = repair_surface(*part, {});
  if (!closed) {
    Issue issue = closed.issue();
    issue.where = where_region(request.name);
    return issue;
  }
  return Contains([inside = std::make_shared<SignedDistance>(closed->mesh)](const Point& p) {
    return inside->contains(p);
  });
}

struct Corners {
  std::array<Point, 4> x;
  Point at(const std::array<double, 4>& weights) const {
    Point p{};
    for (std::size_t k = 0; k < 4; ++k) p = add_scaled(p, weights[k], x[k]);
    return p;
  }
  double volume() const { return signed_volume6(x[0], x[1], x[2], x[3]) / 6; }
};

Corners corners_of(const TetMesh& mesh, std::size_t t) {
  const Tet& tet = mesh.tets[t];
  return {
      {mesh.nodes[at(tet[0])], mesh.nodes[at(tet[1])], mesh.nodes[at(tet[2])], mesh.nodes[at(tet[3])]}};
}

/// Points of equal weight in a tet: a lattice of barycentric coordinates, `steps` a side.
std::vector<std::array<double, 4>> lattice(int steps) {
  std::vector<std::array<double, 4>> points;
  for (int a = 0; a < steps; ++a)
    for (int b = 0; a + b < steps; ++b)
      for (int c = 0; a + b + c < steps; ++c) {
        const int d = steps - 1 - a - b - c;
        std::array<double, 4> w{};
        const std::array<int, 4> count{a, b, c, d};
        for (std::size_t k = 0; k < 4; ++k) w[k] = (count[k] + 0.25) / steps;
        points.push_back(w);
      }
  return points;
}

/// The volume of the part inside the mesh: tets that lie wholly in or out by their corners and middle
/// count as such, the rest by sampling.
double volume_inside(const TetMesh& mesh, const Contains& contains) {
  static const auto samples = lattice(5);
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const Corners corners = corners_of(mesh, t);
    std::size_t inside = contains(corners.at({0.25, 0.25, 0.25, 0.25})) ? 1 : 0;
    for (const Point& p : corners.x) inside += contains(p) ? 1 : 0;
    double share = inside == 5 ? 1 : 0;
    if (inside > 0 && inside < 5) {
      const auto hits =
          std::ranges::count_if(samples, [&](const auto& w) { return contains(corners.at(w)); });
      share = static_cast<double>(hits) / static_cast<double>(samples.size());
    }
    volume += share * corners.volume();
  }
  return volume;
}

/// Tets whose middle lies in the part.
Status assign_part(const RegionRequest& request, const TetMesh& mesh, double scale, Index number,
                   RegionAssignment& assignment, RegionReport& report) {
  const auto contains = containment(request, scale, assignment.file_hashes);
  if (!contains) return contains.issue();
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if ((*contains)(corners_of(mesh, t).at({0.25, 0.25, 0.25, 0.25})))
      assignment.tet_region[t] = number;
  report.wanted_volume_m3 = volume_inside(mesh, *contains);
  return {};
}

Status assign_group(const RegionRequest& request, const TetLabels& labels, Index number,
                    std::vector<Index>& tet_region) {
  const std::string& group = std::get<GroupSelection>(request.where).name;
  const auto found = std::ranges::find(labels.names, group);
  if (found == labels.names.end())
    return make_issue(IssueCode::config_bad_value, "the tet mesh has no group \"" + group + "\"",
                      where_region(request.name),
                      labels.names.empty() ? "The file labels no tets."
                                           : "Its groups are " + join_names(labels.names) + ".");
  const auto label = static_cast<Index>(found - labels.names.begin());
  for (std::size_t t = 0; t < tet_region.size(); ++t)
    if (labels.of_tets[t] == label) tet_region[t] = number;
  return {};
}

void count_tets(const TetMesh& mesh, RegionAssignment& assignment) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    RegionReport& report = assignment.reports[at(assignment.tet_region[t])];
    ++report.tet_count;
    report.volume_m3 += corners_of(mesh, t).volume();
  }
}

}  // namespace

Result<BodyParts> read_local_sizes(const Recipe& recipe, const TriangleMesh& surface, double scale) {
  BodyParts parts;
  for (std::size_t i = 0; i < recipe.refine.size(); ++i) {
    auto size = local_size(recipe.refine[i], surface, scale, parts.file_hashes);
    if (!size) return size.issue();
    const auto* patch = std::get_if<PatchRegion>(&size->region);
    if (patch != nullptr && patch->patch.triangles.empty())
      return make_issue(IssueCode::config_bad_value, "the selection holds no piece of the surface",
                        where_refine(i),
                        "Select with respect to the surface in metres, which spans " +
                            span_text(surface.vertices) + ".");
    parts.local_sizes.push_back(std::move(*size));
  }
  return parts;
}

Result<RegionAssignment> assign_regions(const Recipe& recipe, const TetMesh& mesh,
                                        const TetLabels& labels, double scale) {
  RegionAssignment assignment;
  const MaterialSettings& m = recipe.material;
  assignment.regions.push_back({"default", m.young_pa, m.poisson, m.density_kg_m3});
  if (recipe.regions.empty()) return assignment;
  assignment.tet_region.assign(mesh.tets.size(), 0);
  assignment.reports.emplace_back().name = "default";
  for (const RegionRequest& request : recipe.regions) {
    const auto number = static_cast<Index>(assignment.regions.size());
    assignment.regions.push_back(
        {request.name, request.young_pa, request.poisson, request.density_kg_m3});
    RegionReport& report = assignment.reports.emplace_back();
    report.name = request.name;
    const Status assigned = std::holds_alternative<GroupSelection>(request.where)
                                ? assign_group(request, labels, number, assignment.tet_region)
                                : assign_part(request, mesh, scale, number, assignment, report);
    if (!assigned) return assigned.issue();
  }
  count_tets(mesh, assignment);
  for (std::size_t r = 1; r < assignment.reports.size(); ++r)
    if (assignment.reports[r].tet_count == 0)
      return make_issue(IssueCode::config_bad_value, "no tet has its middle in the region",
                        where_region(assignment.reports[r].name),
                        "Check the place and the unit, use a finer mesh there ([[mesh.refine]]), or "
                        "leave the region out; the mesh spans " +
                            span_text(mesh.nodes) + ".");
  return assignment;
}

}  // namespace souple
