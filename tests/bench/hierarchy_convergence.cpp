// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the levels of a nested hierarchy come to their target, for the three fit rules, and what the
// children keep of their parents' quality: a table on stderr, rows on stdout. Last, how long it takes
// to bind points to a mesh.
//
// Usage: hierarchy_convergence [FILE TETS LEVELS]… (default: the smooth shapes and a machine part)
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/bench/row.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/surface_samples.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/embed_points.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

struct Case {
  std::string file;
  std::size_t tets;
  int levels;
};

const std::vector<Case> default_cases{
    {"liver-smooth.obj", 150, 4}, {"liver-smooth.obj", 1250, 3}, {"dino.off", 1250, 3},
    {"dino.off", 5000, 2},        {"bunny_10k.obj", 1250, 3},    {"bunny_10k.obj", 3000, 3},
    {"blobby.off", 150, 4},       {"blobby.off", 1250, 3},       {"ballA.off", 150, 4},
    {"ballA.off", 1250, 3},       {"anchor.off", 1250, 3}};

struct Rule {
  FitRule rule;
  const char* name;
};
constexpr Rule rules[] = {{FitRule::nearest_three, "nearest_three"},
                          {FitRule::least_squares, "least_squares"},
                          {FitRule::projection, "projection"}};

template <class T>
T value_or_exit(Result<T> result, const std::string& where) {
  if (!result) {
    std::fprintf(stderr, "%s: %s\n", where.c_str(), format_issue(result.issue()).c_str());
    std::exit(exit_code(result.issue().code));
  }
  return std::move(result).value();
}

TriangleMesh closed_surface(const std::string& file) {
  const char* dir = std::getenv("SOUPLE_DATA_DIR");
  const std::filesystem::path folder(dir != nullptr ? dir : SOUPLE_DEFAULT_DATA_DIR);
  ImportOptions options;
  options.size_m = 0.2;
  const auto imported = value_or_exit(import_surface(folder / "surfaces" / file, options), file);
  return value_or_exit(orient_closed_surface(imported.mesh), file).mesh;
}

/// How far the facets are from the curved surface that their corners' normals suggest: the middles of
/// the sides of cubic (PN) triangles. No level can be told to be nearer to the real shape than that.
SurfaceDistance facet_error(const TriangleMesh& mesh) {
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  const auto area_of = [&](const Triangle& t) {
    const Point& a = mesh.vertices[at(t[0])];
    return cross(subtract(mesh.vertices[at(t[1])], a), subtract(mesh.vertices[at(t[2])], a));
  };
  std::vector<Point> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (const Index i : t) normals[at(i)] = add(normals[at(i)], area_of(t));
  SurfaceDistance error;
  double sum = 0, weights = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point &p = normals[at(t[k])], &q = normals[at(t[(k + 1) % 3])];
      const Point side = subtract(mesh.vertices[at(t[(k + 1) % 3])], mesh.vertices[at(t[k])]);
      const Point bulge = subtract(scaled(q, dot(side, q) / squared_norm(q)),
                                   scaled(p, dot(side, p) / squared_norm(p)));
      const double height = norm(bulge) / 8, weight = norm(area_of(t));
      if (!std::isfinite(height)) continue;
      error.largest = std::max(error.largest, height);
      sum += weight * height * height;
      weights += weight;
    }
  if (weights > 0) error.root_mean_square = std::sqrt(sum / weights);
  return error;
}

struct LevelDistance {
  double rms, hausdorff, edge;  ///< m; mean edge of the boundary
};

/// The boundary without the nodes inside.
TriangleMesh boundary_surface(const MeshLevel& level) {
  TriangleMesh surface{{}, level.boundary};
  std::vector<Index> number(level.mesh.nodes.size());
  for (const Index i : used_nodes(level.boundary)) {
    number[static_cast<std::size_t>(i)] = static_cast<Index>(surface.vertices.size());
    surface.vertices.push_back(level.mesh.nodes[static_cast<std::size_t>(i)]);
  }
  for (Triangle& t : surface.triangles)
    for (Index& i : t) i = number[static_cast<std::size_t>(i)];
  return surface;
}

std::vector<LevelDistance> distances(const Hierarchy& hierarchy, const TriangleMesh& target) {
  std::vector<LevelDistance> all;
  for (const MeshLevel& level : hierarchy.levels) {
    double edges = 0;
    for (const Triangle& t : level.boundary)
      for (std::size_t k = 0; k < 3; ++k)
        edges += norm(subtract(level.mesh.nodes[static_cast<std::size_t>(t[k])],
                               level.mesh.nodes[static_cast<std::size_t>(t[(k + 1) % 3])]));
    const TwoSidedDistance d = two_sided_distance(boundary_surface(level), target);
    all.push_back(
        {d.root_mean_square(), d.hausdorff(), edges / static_cast<double>(3 * level.boundary.size())});
  }
  return all;
}

/// The least quotient of neighbouring levels, over the steps that start where the edge resolves the
/// shape (nothing is farther off than half an edge) and have room to fall by `asked` before the facets
/// of the target are reached. Infinity: no such step.
double least_fall(const std::vector<LevelDistance>& levels, double LevelDistance::*of, double floor,
                  double asked) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t l = 0; l + 1 < levels.size(); ++l)
    if (levels[l].hausdorff < 0.5 * levels[l].edge && levels[l].*of >= asked * floor)
      least = std::min(least, levels[l].*of / (levels[l + 1].*of));
  return least;
}

TetMesh tet_mesh(const TriangleMesh& surface, std::size_t tets, const std::string& file) {
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  return value_or_exit(tetrahedralize(surface, options), file).mesh;
}

/// 100 000 points between vertices of the surface and nodes of the mesh, and a little beyond.
void print_embedding_row() {
  const std::string file = "liver-smooth.obj";
  const TriangleMesh surface = closed_surface(file);
  const TetMesh mesh = tet_mesh(surface, 10000, file);
  std::mt19937 random(11);
  const auto any_of = [&](const std::vector<Point>& points) {
    return points[random() % points.size()];
  };
  std::vector<Point> points;
  for (int i = 0; i < 100'000; ++i) {
    const Point from = any_of(surface.vertices), way = subtract(any_of(mesh.nodes), from);
    const double part = 1.1 * static_cast<double>(random()) / std::mt19937::max() - 0.05;
    points.push_back(add_scaled(from, part, way));
  }
  ResultHash hash;
  const std::vector<double> seconds = repeated_seconds(5, [&] {
    const EmbeddedPoints embedded = value_or_exit(embed_points(points, mesh), file);
    hash = {};
    for (const Embedding& row : embedded.rows) hash.add(std::span<const double>(row.weights));
  });
  print_row("hierarchy.embed_100k", "ms", seconds, hash, 1e3);
}

class Table {
 public:
  void run(const Case& c) {
    const TriangleMesh target = closed_surface(c.file);
    const TetMesh coarse = tet_mesh(target, c.tets, c.file);
    const SurfaceDistance facets = facet_error(target);
    std::fprintf(
        stderr,
        "\n%s, %zu tets, longest side 200 mm; facets of the target: rms %.0f um, largest %.0f um\n",
        c.file.c_str(), coarse.tets.size(), 1e6 * facets.root_mean_square, 1e6 * facets.largest);
    std::fprintf(stderr, "%-14s %5s %8s %8s %8s %6s %8s %6s %7s %7s %7s %9s %9s\n", "rule", "level",
                 "tets", "edge_um", "rms_um", "fall", "haus_um", "fall", "keep70", "worst", "dihedr",
                 "rigid_par", "held");
    for (const Rule& rule : rules) run_rule(c, rule, target, coarse, facets);
  }

  void print_rows() const {
    for (const auto& [name, least] : falls_)
      if (std::isfinite(least)) print_row("hierarchy.fall." + name, "1", least, hash_);
    print_row("hierarchy.children.share_keeping_70", "%", 100 * share_keeping_70_, hash_);
    print_row("hierarchy.children.worst_kept", "%", 100 * worst_kept_, hash_);
    print_row("hierarchy.rigid.parents", "1", rigid_parents_, hash_);
    print_row("hierarchy.rigid.embedding", "1", rigid_embedding_, hash_);
  }

 private:
  void run_rule(const Case& c, const Rule& rule, const TriangleMesh& target, const TetMesh& coarse,
                const SurfaceDistance& facets) {
    Hierarchy hierarchy;
    const double seconds = seconds_of([&] {
      hierarchy = value_or_exit(
          build_nested_hierarchy(coarse, target, {c.levels, DiagonalRule::best_quality, rule.rule}),
          c.file);
    });
    const std::vector<LevelDistance> levels = distances(hierarchy, target);
    for (std::size_t l = 0; l < levels.size(); ++l) print_level(rule, l, levels, hierarchy.reports[l]);
    const double rms = least_fall(levels, &LevelDistance::rms, facets.root_mean_square, 3.5);
    const double hausdorff = least_fall(levels, &LevelDistance::hausdorff, facets.largest, 2.5);
    std::fprintf(stderr, "%-14s %.2f s; least fall where it counts: rms %.2f, hausdorff %.2f\n",
                 rule.name, seconds, rms, hausdorff);
    const std::string name = std::string(rule.name) + "." + c.file.substr(0, c.file.find('.'));
    record(falls_, name + ".rms", rms);
    record(falls_, name + ".hausdorff", hausdorff);
    if (rule.rule != FitRule::projection) return;
    for (std::size_t l = 1; l < levels.size(); ++l) {
      const LevelReport& report = hierarchy.reports[l];
      share_keeping_70_ = std::min(share_keeping_70_, report.children.share_keeping_70);
      worst_kept_ = std::min(worst_kept_, report.children.worst_kept);
      rigid_parents_ = std::max(rigid_parents_, report.rigid_motion_error.parents);
      rigid_embedding_ = std::max(rigid_embedding_, report.rigid_motion_error.embedding);
      hash_.add(hierarchy.levels[l].mesh.nodes);
    }
  }

  static void record(std::map<std::string, double>& falls, const std::string& name, double fall) {
    const auto [entry, is_new] = falls.emplace(name, fall);
    if (!is_new) entry->second = std::min(entry->second, fall);
  }

  static void print_level(const Rule& rule, std::size_t l, const std::vector<LevelDistance>& levels,
                          const LevelReport& report) {
    const LevelDistance &now = levels[l], &before = levels[l == 0 ? 0 : l - 1];
    std::fprintf(stderr,
                 "%-14s %5zu %8zu %8.0f %8.1f %6.2f %8.0f %6.2f %6.2f%% %6.1f%% %7.2f %9.2e %9zu\n",
                 rule.name, l, report.tet_count, 1e6 * now.edge, 1e6 * now.rms, before.rms / now.rms,
                 1e6 * now.hausdorff, before.hausdorff / now.hausdorff,
                 100 * report.children.share_keeping_70, 100 * report.children.worst_kept,
                 report.min_dihedral_deg, report.rigid_motion_error.parents, report.held_back_count);
  }

  std::map<std::string, double> falls_;
  double share_keeping_70_ = 1, worst_kept_ = 1, rigid_parents_ = 0, rigid_embedding_ = 0;
  ResultHash hash_;
};

}  // namespace
}  // namespace souple::bench

int main(int argument_count, char** arguments) {
  using namespace souple::bench;
  std::vector<Case> cases;
  for (int i = 1; i + 2 < argument_count; i += 3)
    cases.push_back({arguments[i], std::strtoul(arguments[i + 1], nullptr, 10),
                     static_cast<int>(std::strtol(arguments[i + 2], nullptr, 10))});
  Table table;
  for (const Case& c : cases.empty() ? default_cases : cases) table.run(c);
  table.print_rows();
  print_embedding_row();
  return 0;
}
