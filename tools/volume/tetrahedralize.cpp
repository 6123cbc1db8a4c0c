// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/tetrahedralize.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <optional>
#include <string>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/volume/surface_seeds.hpp"
#include "tools/volume/unit_surface.hpp"
#include "tools/volume/volume_mesher.hpp"

namespace souple {
namespace {

constexpr std::size_t fewest_tets = 20, most_tets = 5'000'000;
constexpr std::size_t most_attempts = 6;
constexpr int most_retries = 8;
constexpr double retry_step = 0.015;
/// How near the target the refinement and, after the slivers are gone, the mesh must come.
constexpr double good_enough = 0.07, near_enough = 0.12;
/// Perturbing and exuding leave about this part of the refinement's tets.
constexpr double left_by_optimisation = 0.97;
/// Measured on livers, animals and CAD parts of 1k to 50k tets with the sizes below: a mesh of cell
/// radius h has about cells V / h^3 + skin A / h^2 tets.
constexpr double cells = 3.9, skin = 2.2;
/// Mean edge of the result over the cell radius that was asked for.
constexpr double edge_per_radius = 1.3;
/// In cell radii. Wide seeds miss legs and tails thinner than a tet: with 3, 2, 1.4, 1 the farthest
/// vertex of a dinosaur's surface lay 18, 18, 6, 10 % of its size from a mesh of 1000 tets. One shape,
/// not a law.
constexpr double seed_spacing = 1.4;
constexpr std::size_t fewest_seeds = 8, most_seeds = 5000;
/// Below that fraction of the surface's volume, parts of the shape are missing.
constexpr double least_volume_kept = 0.75, most_volume_gained = 1.25;

MesherSizes sizes_of(double radius) { return {radius, 0.9 * radius, 0.12 * radius}; }

double expected_tets(double volume, double area, double radius) {
  return cells * volume / (radius * radius * radius) + skin * area / (radius * radius);
}

/// The radius for which expected_tets is `target`, by bisection of its logarithm.
double radius_for(double volume, double area, double target) {
  double low = 1e-4, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (expected_tets(volume, area, middle) > target ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

struct Attempt {
  double radius;
  double count;
};

/// log count is nearly linear in log radius: slope -3 for a solid, towards -2 where the skin dominates.
double next_radius(const std::vector<Attempt>& attempts, double target) {
  const Attempt& last = attempts.back();
  double slope = -3;
  if (attempts.size() > 1) {
    const Attempt& before = attempts[attempts.size() - 2];
    const double run = std::log(last.radius / before.radius);
    if (std::abs(run) > 1e-6) slope = std::clamp(std::log(last.count / before.count) / run, -4.5, -1.5);
  }
  return last.radius * std::exp(std::log(target / last.count) / slope);
}

double miss(const Attempt& attempt, double target) { return std::abs(attempt.count / target - 1); }

/// Refines until the count is near the target and returns all attempts, the best one last.
Result<std::vector<Attempt>> refine_to_count(VolumeMesher& mesher, double radius, double target) {
  std::vector<Attempt> attempts;
  const auto most_vertices = static_cast<std::size_t>(4 * target) + 20'000;
  const auto refine = [&](double r) -> Status {
    const Result<std::size_t> count = mesher.refine(sizes_of(r), most_vertices);
    if (!count) return count.issue();
    attempts.push_back({r, std::max(1.0, static_cast<double>(*count))});
    return {};
  };
  while (attempts.empty() || miss(attempts.back(), target) > good_enough) {
    if (attempts.size() == most_attempts) {
      const Attempt best =
          *std::ranges::min_element(attempts, {}, [&](const Attempt& a) { return miss(a, target); });
      if (const Status refined = refine(best.radius); !refined) return refined.issue();
      break;
    }
    if (!attempts.empty()) radius = next_radius(attempts, target);
    if (const Status refined = refine(radius); !refined) return refined.issue();
  }
  return attempts;
}

/// Interleaves the bits of 3 x 21-bit coordinates: nodes near in space become near in memory.
std::uint64_t morton_code(const Point& unit) {
  std::uint64_t code = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double cell = std::clamp((unit[k] + 0.5) * 0x1p21, 0.0, 0x1p21 - 1);
    const auto bits = static_cast<std::uint64_t>(cell);
    for (unsigned b = 0; b < 21; ++b) code |= ((bits >> b) & 1) << (3 * b + k);
  }
  return code;
}

/// Nodes along the Morton curve, tets positive and sorted: an order that depends on the geometry alone.
TetMesh in_canonical_order(const TetMesh& mesh) {
  std::vector<std::uint64_t> codes;
  for (const Point& p : mesh.nodes) codes.push_back(morton_code(p));
  std::vector<Index> order(mesh.nodes.size()), rank(mesh.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](Index ia, Index ib) {
    const auto a = static_cast<std::size_t>(ia), b = static_cast<std::size_t>(ib);
    return codes[a] != codes[b] ? codes[a] < codes[b] : mesh.nodes[a] < mesh.nodes[b];
  });
  TetMesh sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[static_cast<std::size_t>(order[i])] = static_cast<Index>(i);
    sorted.nodes.push_back(mesh.nodes[static_cast<std::size_t>(order[i])]);
  }
  for (Tet tet : mesh.tets) {
    for (Index& i : tet) i = rank[static_cast<std::size_t>(i)];
    std::ranges::sort(tet);
    const auto node = [&](std::size_t k) { return sorted.nodes[static_cast<std::size_t>(tet[k])]; };
    if (signed_volume6(node(0), node(1), node(2), node(3)) < 0) std::swap(tet[2], tet[3]);
    sorted.tets.push_back(tet);
  }
  std::ranges::sort(sorted.tets);
  return sorted;
}

Status check_tets(const TetMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto node = [&](std::size_t k) {
      return mesh.nodes[static_cast<std::size_t>(mesh.tets[t][k])];
    };
    if (!(signed_volume6(node(0), node(1), node(2), node(3)) > 0))
      return make_issue(IssueCode::meshing_failed, "tet " + std::to_string(t) + " came out flat");
  }
  return {};
}

/// The boundary must be a clean surface, and enclose about what `unit` encloses, in as many shells.
Status check_against_surface(const TetMesh& mesh, const TriangleMesh& unit) {
  if (mesh.tets.empty()) return make_issue(IssueCode::meshing_lost_volume, "the mesh came out empty");
  const std::vector<Triangle> boundary = boundary_triangles(mesh.tets);
  const SurfaceTopology found = measure_topology(boundary, mesh.nodes.size());
  if (!found.closed_oriented_manifold())
    return make_issue(IssueCode::meshing_boundary_not_manifold,
                      std::to_string(found.nonmanifold_edge_count) + " edges and " +
                          std::to_string(found.nonmanifold_vertex_count) + " nodes of the boundary");
  const double kept = signed_volume({mesh.nodes, boundary}) / signed_volume(unit);
  if (kept < least_volume_kept || kept > most_volume_gained)
    return make_issue(IssueCode::meshing_lost_volume,
                      "the tets fill " + std::to_string(100 * kept) + " % of the surface's volume");
  const SurfaceTopology asked = measure_topology(unit.triangles, unit.vertices.size());
  if (found.shell_count < asked.shell_count)
    return make_issue(IssueCode::meshing_lost_volume,
                      "of " + std::to_string(asked.shell_count) + " shells of the surface " +
                          std::to_string(found.shell_count) + " are left");
  return {};
}

/// Cell radius to start from, and the count to aim at (0: take the first mesh).
struct Aim {
  double radius;
  double count;
};

Result<Aim> aim_of(const UnitSurface& unit, const TetrahedralizeOptions& options) {
  const double volume = signed_volume(unit.mesh), area = surface_area(unit.mesh);
  const double edge = options.edge_length_m;
  if (edge == 0) {
    if (options.target_tet_count < fewest_tets || options.target_tet_count > most_tets)
      return make_issue(IssueCode::usage_bad_value,
                        "a target of " + std::to_string(options.target_tet_count) +
                            " tets is outside " + std::to_string(fewest_tets) + " to " +
                            std::to_string(most_tets));
    const auto count = static_cast<double>(options.target_tet_count);
    return Aim{radius_for(volume, area, count), count};
  }
  if (!(edge > 0) || !std::isfinite(edge))
    return make_issue(IssueCode::usage_bad_value, "the edge length must be positive and finite");
  const double radius = edge / unit.length_m / edge_per_radius;
  if (!(radius <= 1))
    return make_issue(IssueCode::usage_bad_value, "the edge length exceeds the size of the body");
  if (expected_tets(volume, area, radius) > static_cast<double>(most_tets))
    return make_issue(IssueCode::usage_bad_value,
                      "the edge length asks for more than " + std::to_string(most_tets) + " tets");
  return Aim{radius, 0};
}

Result<std::vector<Attempt>> refine_towards(VolumeMesher& mesher, const Aim& aim) {
  if (aim.count > 0) return refine_to_count(mesher, aim.radius, aim.count / left_by_optimisation);
  const Result<std::size_t> count = mesher.refine(sizes_of(aim.radius), most_tets);
  if (!count) return count.issue();
  return std::vector<Attempt>{{aim.radius, static_cast<double>(*count)}};
}

struct Mesh {
  TetMesh tets;
  int attempts = 0;
};

/// Perturbing and exuding may pinch the boundary at a node or an edge, or cost more tets than usual. It
/// is an accident of one triangulation: slightly other cell radii, on either side, are tried until one
/// is sound and near the target; else the nearest sound one is taken.
Result<Mesh> optimise_soundly(VolumeMesher& mesher, const UnitSurface& unit, const Aim& aim,
                              const std::vector<Attempt>& attempts) {
  Mesh best{{}, static_cast<int>(attempts.size())};
  std::optional<Issue> refusal;
  const auto miss_of = [&](const TetMesh& mesh) {
    return aim.count > 0 ? miss({0, static_cast<double>(mesh.tets.size())}, aim.count) : 0;
  };
  for (int retry = 0; retry <= most_retries; ++retry) {
    if (retry > 0) {
      const int sign = retry % 2 == 1 ? 1 : -1;
      const double radius = attempts.back().radius * (1 + sign * retry_step * ((retry + 1) / 2));
      const Result<std::size_t> count = mesher.refine(sizes_of(radius), most_tets);
      if (!count) return count.issue();
      ++best.attempts;
    }
    Result<TetMesh> raw = mesher.optimise();
    if (!raw) return raw.issue();
    if (const Status sound = check_against_surface(*raw, unit.mesh); !sound) {
      refusal = sound.issue();
      if (refusal->code != IssueCode::meshing_boundary_not_manifold) return *refusal;
      continue;
    }
    if (best.tets.tets.empty() || miss_of(*raw) < miss_of(best.tets)) best.tets = std::move(*raw);
    if (miss_of(best.tets) <= near_enough) return best;
  }
  if (best.tets.tets.empty()) return *refusal;
  return best;
}

}  // namespace

Result<TetrahedralizedVolume> tetrahedralize(const TriangleMesh& surface,
                                             const TetrahedralizeOptions& options) try {
  const Result<UnitSurface> unit = to_unit_surface(surface);
  if (!unit) return unit.issue();
  const Result<Aim> aim = aim_of(*unit, options);
  if (!aim) return aim.issue();
  VolumeMesher mesher(unit->mesh, spread_surface_seeds(unit->mesh, seed_spacing * aim->radius,
                                                       fewest_seeds, most_seeds));
  const Result<std::vector<Attempt>> attempts = refine_towards(mesher, *aim);
  if (!attempts) return attempts.issue();
  const Result<Mesh> raw = optimise_soundly(mesher, *unit, *aim, *attempts);
  if (!raw) return raw.issue();

  TetrahedralizedVolume volume;
  volume.mesh = in_canonical_order(raw->tets);
  for (Point& p : volume.mesh.nodes) p = add_scaled(unit->origin, unit->length_m, p);
  if (const Status positive = check_tets(volume.mesh); !positive) return positive.issue();
  volume.report = {volume.mesh.nodes.size(), volume.mesh.tets.size(), raw->attempts,
                   measure_tet_quality(volume.mesh)};
  return volume;
} catch (const std::exception& e) {
  return make_issue(IssueCode::meshing_failed, e.what());
}

}  // namespace souple
