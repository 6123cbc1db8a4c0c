// SPDX-License-Identifier: GPL-3.0-or-later
// How much smaller the stored compliance is than raw doubles (72 bytes per pair of nodes): what an
// asset file grows by, index, chunks and checksums included. Bodies of the reference scale and
// material.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <string>

#include "formats/write/asset_writer.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tools/compliance/precompute.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/repair.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

constexpr double diagonal_m = 0.2;
constexpr std::array<int, 4> patch_radii_mm{10, 15, 20, 40};

/// Ball about the lowest node.
FixedSet bottom_patch(const TetMesh& mesh, int radius_mm) {
  const auto lowest = std::ranges::min_element(mesh.nodes, {}, [](const Point& p) { return p[1]; });
  FixedSet patch{"bottom_" + std::to_string(radius_mm), {}};
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k)
    if ((as_vec3(mesh.nodes[k]) - as_vec3(*lowest)).norm() < 1e-3 * radius_mm)
      patch.nodes.push_back(Index(k));
  return patch;
}

Asset make_body(const char* file, std::size_t tets) {
  ImportOptions import;
  import.size_m = diagonal_m;
  const auto surface = value_or_exit(import_surface(data_folder() / "surfaces" / file, import)).mesh;
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  Asset asset;
  MeshLevel& level = asset.levels.emplace_back();
  level.mesh =
      value_or_exit(tetrahedralize(value_or_exit(repair_surface(surface, {})).mesh, options)).mesh;
  level.boundary = boundary_triangles(level.mesh.tets);
  Eigen::AlignedBox3d box;
  for (const Point& p : level.mesh.nodes) box.extend(as_vec3(p));
  for (Point& p : level.mesh.nodes) p = as_point(as_vec3(p) * (diagonal_m / box.diagonal().norm()));
  asset.material.regions.push_back({"all", 1e4, 0.4, 1000});
  asset.material.rayleigh_mass_per_s = 0.1;
  asset.material.rayleigh_stiffness_s = 0.01;
  for (const int radius_mm : patch_radii_mm)
    asset.fixed_sets.push_back(bottom_patch(level.mesh, radius_mm));
  return asset;
}

struct Variant {
  ComplianceKind kind = ComplianceKind::dynamic_step;
  double time_step_s = 0.01;
  ErrorNorm norm = ErrorNorm::frobenius;
  std::size_t patch = 0;  ///< of a static one, in patch_radii_mm
};

struct Outcome {
  double ratio = 0, asked_over_measured = 0;
  std::int64_t nodes = 0;
};

Outcome measure(Asset asset, const Variant& variant, const std::string& name) {
  const std::size_t without = value_or_exit(write_asset_memory(asset)).size();
  CompliancePrecomputeOptions options;
  options.kind = variant.kind;
  options.time_step_s = variant.time_step_s;
  options.norm = variant.norm;
  options.tolerance = 1e-3;
  const FixedSet* fixed =
      variant.kind == ComplianceKind::static_equilibrium ? &asset.fixed_sets[variant.patch] : nullptr;
  asset.compliances.push_back(value_or_exit(
      precompute_compliance(asset.levels.back(), nullptr, asset.material, fixed, options, {})));
  const ComplianceHeader& header = asset.compliances[0].header;
  Outcome outcome;
  outcome.nodes = header.node_count;
  const auto bytes = value_or_exit(write_asset_memory(asset));
  outcome.ratio = 72.0 * double(outcome.nodes) * double(outcome.nodes) / double(bytes.size() - without);
  outcome.asked_over_measured =
      1e-3 /
      (variant.norm == ErrorNorm::frobenius ? header.error.frobenius : header.error.worst_column);
  ResultHash hash;
  hash.add(asset.compliances[0].payload);
  std::fprintf(stderr, "%s: %lld nodes, %zu bytes\n", name.c_str(),
               static_cast<long long>(outcome.nodes), bytes.size() - without);
  print_row("compliance.size." + name, "1", outcome.ratio, hash);
  return outcome;
}

void run() {
  const ComplianceKind dynamic = ComplianceKind::dynamic_step;
  const Asset small = make_body("bunny_10k.obj", 2400), bunny = make_body("bunny_10k.obj", 9680);
  const Asset liver = make_body("liver-smooth.obj", 52800);
  double loosest = std::numeric_limits<double>::max(), tightest = 0;
  const auto add = [&](const Asset& body, const Variant& variant, const std::string& name) {
    const Outcome outcome = measure(body, variant, name);
    loosest = std::min(loosest, outcome.asked_over_measured);
    tightest = std::max(tightest, outcome.asked_over_measured);
    return outcome.ratio;
  };
  const double few = add(small, {dynamic, 0.01, ErrorNorm::frobenius}, "bunny_644.frobenius");
  const double some = add(bunny, {dynamic, 0.01, ErrorNorm::frobenius}, "bunny.frobenius");
  add(bunny, {dynamic, 0.01, ErrorNorm::worst_column}, "bunny.worst_column");
  for (std::size_t patch = 0; patch < patch_radii_mm.size(); ++patch)
    add(bunny, {ComplianceKind::static_equilibrium, 0, ErrorNorm::worst_column, patch},
        "bunny_static_" + std::to_string(patch_radii_mm[patch]) + "mm.worst_column");
  const double many = add(liver, {dynamic, 0.02, ErrorNorm::frobenius}, "liver.frobenius");
  add(liver, {dynamic, 0.02, ErrorNorm::worst_column}, "liver.worst_column");
  const ResultHash none;
  print_row("compliance.size.growth", "1", std::min(some / few, many / some), none);
  print_row("compliance.size.asked_over_measured.least", "1", loosest, none);
  print_row("compliance.size.asked_over_measured.most", "1", tightest, none);
}

}  // namespace
}  // namespace souple::bench

int main() { souple::bench::run(); }
