// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh stages on real surfaces: time of 50k tets from repair to tets; the same shape in other
// units, elsewhere and turned.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/surface/decimate.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/repair.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

TriangleMesh read_surface(const char* name) {
  ImportOptions options;
  options.size_m = 0.2;
  return value_or_exit(import_surface(data_folder() / "surfaces" / name, options)).mesh;
}

TetMesh tets_of(const TriangleMesh& surface, std::size_t tets, std::size_t faces) {
  const auto repaired = value_or_exit(repair_surface(surface, {}));
  const auto decimated = value_or_exit(decimate_surface(repaired.mesh, {faces}));
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  return value_or_exit(tetrahedralize(decimated.mesh, options)).mesh;
}

void time_liver_50k() {
  const TriangleMesh surface = read_surface("liver-smooth.obj");
  std::vector<double> repair_s, mesh_s, total_s;
  ResultHash hash;
  double tets = 0;
  for (int run = 0; run < 3; ++run) {
    RepairedSurface repaired;
    TetrahedralizedVolume volume;
    repair_s.push_back(seconds_of([&] { repaired = value_or_exit(repair_surface(surface, {})); }));
    mesh_s.push_back(seconds_of([&] {
      TetrahedralizeOptions options;
      options.target_tet_count = 50000;
      volume = value_or_exit(tetrahedralize(repaired.mesh, options));
    }));
    total_s.push_back(repair_s.back() + mesh_s.back());
    tets = static_cast<double>(volume.mesh.tets.size());
    hash = ResultHash();
    hash.add(volume.mesh.nodes);
  }
  print_row("mesh.liver_50k.total", "s", total_s, hash);
  print_row("mesh.liver_50k.repair", "s", repair_s, hash);
  print_row("mesh.liver_50k.tetrahedralize", "s", mesh_s, hash);
  print_row("mesh.liver_50k.tets", "1", tets, hash);
}

/// x -> scale x + shift, carried out and rounded as a file in other units would be.
TriangleMesh placed(TriangleMesh surface, double scale, double shift) {
  for (Point& p : surface.vertices)
    for (double& x : p) x = scale * x + shift;
  return surface;
}

TriangleMesh turned(TriangleMesh surface, double angle) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (Point& p : surface.vertices) {
    const Eigen::Vector3d x = rotation * Eigen::Vector3d(p[0], p[1], p[2]);
    p = {x[0], x[1], x[2]};
  }
  return surface;
}

/// Largest difference of node coordinates over the size of the body (0.2 m); infinite if the tets
/// differ.
double difference(const Hierarchy& a, const Hierarchy& b, double scale, double shift) {
  double largest = 0;
  for (std::size_t l = 0; l < a.levels.size(); ++l) {
    const TetMesh &x = a.levels[l].mesh, &y = b.levels[l].mesh;
    if (x.tets != y.tets) return INFINITY;
    for (std::size_t i = 0; i < x.nodes.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        largest = std::max(largest, std::abs((y.nodes[i][k] - shift) / scale - x.nodes[i][k]) / 0.2);
  }
  return largest;
}

Hierarchy levels_of(const TriangleMesh& surface) {
  return value_or_exit(build_nested_hierarchy(tets_of(surface, 1250, 4000), surface, {}));
}

void compare_frames(const char* name, const std::string& label) {
  const TriangleMesh surface = read_surface(name);
  const Hierarchy base = levels_of(surface);
  const auto row = [&](const char* what, double scale, double shift) {
    print_row("mesh.invariance." + label + "." + what, "L",
              difference(base, levels_of(placed(surface, scale, shift)), scale, shift), ResultHash());
  };
  row("mm", 1000, 0);
  row("km", 1e-3, 0);
  row("far", 1, 50);  // 250 body lengths away
  const double count = static_cast<double>(base.levels[0].mesh.tets.size());
  const double quality = base.reports[0].min_dihedral_deg;
  double count_change = 0, quality_loss = 0;
  for (const double angle : {0.3, 0.9, 1.7, 2.6}) {
    const Hierarchy other = levels_of(turned(surface, angle));
    const double tets = static_cast<double>(other.levels[0].mesh.tets.size());
    count_change = std::max(count_change, std::abs(tets / count - 1));
    quality_loss = std::max(quality_loss, std::abs(other.reports[0].min_dihedral_deg / quality - 1));
  }
  print_row("mesh.invariance." + label + ".turned_count", "%", 100 * count_change, ResultHash());
  print_row("mesh.invariance." + label + ".turned_quality", "%", 100 * quality_loss, ResultHash());
}

}  // namespace
}  // namespace souple::bench

int main(int count, char**) {
  using namespace souple::bench;
  time_liver_50k();
  if (count > 1) return 0;  // any argument: the times only
  compare_frames("liver-smooth.obj", "liver");
  compare_frames("dino.off", "dino");
  compare_frames("bunny_10k.obj", "bunny");
  compare_frames("anchor.off", "anchor");
  return 0;
}
