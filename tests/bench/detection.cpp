// SPDX-License-Identifier: GPL-3.0-or-later
// Detection for two soft bodies of about 10 000 boundary triangles that roll on one another: 100 frames
// of a scripted motion, each body flattened where they touch. Thread time, so that other programs do
// not count.
#include <algorithm>
#include <cmath>
#include <string>

#include "runtime/collision/leaf_pairs.hpp"
#include "runtime/collision/local_minima.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/machine_peaks.hpp"
#include "tests/bench/row.hpp"
#include "tools/surface/decimate.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"

namespace souple::bench {
namespace {

constexpr int frame_count = 100;
constexpr std::size_t triangle_target = 10000;
constexpr double size_m = 0.2, alarm_m = 0.003, reach_m = 0.01, pressed_m = 0.004;

TriangleMesh closed_surface(const std::string& file) {
  ImportOptions options;
  options.size_m = size_m;
  auto imported = value_or_exit(import_surface(data_folder() / "surfaces" / file, options));
  auto oriented = value_or_exit(orient_closed_surface(imported.mesh));
  if (oriented.mesh.triangles.size() <= triangle_target) return std::move(oriented.mesh);
  return value_or_exit(decimate_surface(oriented.mesh, {triangle_target, 0})).mesh;
}

struct SoftSurface {
  explicit SoftSurface(const std::string& file)
      : mesh(closed_surface(file)),
        tree(mesh.vertices, mesh.triangles),
        x(3 * Eigen::Index(mesh.vertices.size())),
        surface(tree) {}

  // Turned about y and bent by a slow wave; its lowest point (`side` 1) or highest (-1) is pressed by
  // pressed_m into the plane z = 0 at x = y = 0, which flattens what is beyond to a fiftieth.
  void pose(double angle, double phase, double side) {
    const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
    Vec3 tip = Vec3::Constant(1e9);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      Vec3 p = as_vec3(mesh.vertices[v]);
      p.x() += 0.003 * std::sin(40 * p.y() + phase);
      p = turn * p;
      x.segment<3>(3 * Eigen::Index(v)) = p;
      if (side * p.z() < side * tip.z() || tip.z() == 1e9) tip = p;
    }
    for (Eigen::Index v = 0; v < x.size() / 3; ++v) {
      auto p = x.segment<3>(3 * v);
      p -= tip + Vec3(0, 0, side * pressed_m);
      if (side * p.z() < 0) p.z() *= 0.02;
    }
  }

  TriangleMesh mesh;
  SurfaceTree tree;
  Eigen::VectorXd x;
  DeformedSurface surface;
};

// As World's first detection: the closest point of the other for every node, one node at a time.
std::size_t closest_points(const SoftSurface& a, const SoftSurface& b) {
  std::size_t count = 0;
  Eigen::AlignedBox3d near = b.surface.bounds();
  near.min().array() -= alarm_m + reach_m;
  near.max().array() += alarm_m + reach_m;
  for (const Index node : a.tree.nodes()) {
    const Vec3 point = node_entry(a.x, node);
    if (!near.contains(point)) continue;
    const SurfaceHit hit = b.surface.closest(point, alarm_m + reach_m);
    if (hit.triangle < 0) continue;
    const Vec3 outward = b.surface.pseudo_normal(hit);
    const double gap = (point - hit.closest.point).dot(outward) < 0 ? -hit.distance : hit.distance;
    count += gap <= alarm_m && outward.dot(a.surface.vertex_normal(node)) <= 0.3;
  }
  return count;
}

struct Figures {
  std::vector<double> refit, traversal, minima, frame, naive, ratio, self, count;
};

void run_frame(SoftSurface& a, SoftSurface& b, int frame, ProximityWork& work,
               std::vector<LocalMinimum>& found, Figures& figures, ResultHash& hash) {
  const double angle = 0.02 * frame;
  a.pose(angle, 0.1 * frame, 1);
  b.pose(-angle, 1 + 0.1 * frame, -1);
  const double start = thread_seconds();
  a.surface.refit(a.x);
  b.surface.refit(b.x);
  const double refitted = thread_seconds();
  found.clear();
  find_local_minima(a.surface, b.surface, alarm_m, reach_m, work, found);
  const double end = thread_seconds();
  find_leaf_pairs(a.surface.tree(), a.surface.boxes(), b.surface.tree(), b.surface.boxes(), alarm_m,
                  work.arrays());
  figures.traversal.push_back(thread_seconds() - end);
  const double naive_start = thread_seconds();
  const std::size_t naive_count = closest_points(a, b) + closest_points(b, a);
  const double naive_end = thread_seconds();
  const std::size_t count = found.size();
  for (const LocalMinimum& m : found) hash.add(std::span<const double>(&m.gap, 1));
  const double self_start = thread_seconds();
  find_self_minima(a.surface, alarm_m, reach_m, work, found);
  const double self_end = thread_seconds();
  if (naive_count == 0) exit_with(make_issue(IssueCode::internal_error, "the bodies do not touch"));
  figures.refit.push_back(refitted - start);
  figures.minima.push_back(end - refitted);
  figures.frame.push_back(end - start);
  figures.naive.push_back(refitted - start + naive_end - naive_start);
  figures.ratio.push_back((refitted - start + naive_end - naive_start) / (end - start));
  figures.self.push_back(self_end - self_start);
  figures.count.push_back(double(count));
}

/// The hierarchy is made from the boundary when an asset is loaded, not read from it: what that costs.
std::vector<double> time_builds(const TriangleMesh& mesh) {
  std::vector<double> seconds;
  for (int run = 0; run < 11; ++run) {
    std::vector<Triangle> boundary = mesh.triangles;
    const double start = thread_seconds();
    const SurfaceTree tree(mesh.vertices, std::move(boundary));
    seconds.push_back(thread_seconds() - start);
    if (tree.triangles().empty()) exit_with(make_issue(IssueCode::internal_error, "no hierarchy"));
  }
  return seconds;
}

void run() {
  SoftSurface a("bunny_10k.obj"), b("knot2.off");
  ProximityWork work;
  std::vector<LocalMinimum> found;
  Figures figures;
  ResultHash hash;
  for (int frame = 0; frame < frame_count; ++frame) run_frame(a, b, frame, work, found, figures, hash);
  print_row("detection.triangles", "1", double(a.mesh.triangles.size() + b.mesh.triangles.size()),
            hash);
  print_row("detection.build", "ms", time_builds(a.mesh), hash, 1e3);
  print_row("detection.frame", "ms", figures.frame, hash, 1e3);
  print_row("detection.refit", "ms", figures.refit, hash, 1e3);
  print_row("detection.traversal", "ms", figures.traversal, hash, 1e3);
  print_row("detection.minima", "ms", figures.minima, hash, 1e3);
  print_row("detection.count", "1", figures.count, hash);
  print_row("detection.naive", "ms", figures.naive, hash, 1e3);
  print_row("detection.faster_than_naive", "x", figures.ratio, hash);
  print_row("detection.self", "ms", figures.self, hash, 1e3);
}

}  // namespace
}  // namespace souple::bench

int main() { souple::bench::run(); }
