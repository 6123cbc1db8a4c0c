// SPDX-License-Identifier: GPL-3.0-or-later
// The compliance of a graded bunny from solves alone: time, bytes, memory and how they grow.
// Usage: compliance_by_solves [large]: 3k and 12k surface nodes; large: 3k and 50k; all of them stored
// and certified.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>

#include "runtime/fem/corotational_model.hpp"
#include "tests/bench/row.hpp"
#include "tools/compliance/compress_by_solves.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

constexpr double tolerance = 1e-3;
// Reference scale and material (diagonal 0.2 m, h 0.01 s; alpha 0.1 and beta 0.01).
constexpr double diagonal_m = 0.2, mass_factor = 1e4 + 10, stiffness_factor = 2;
constexpr double coarsening = 8;  // edge deep inside over that at the surface

struct Case {
  const char* name;
  double edge_length_m;  ///< for a longest side of 0.2 m
};
constexpr Case small_case{"3k", 0.0068}, middle_case{"12k", 0.0033}, large_case{"50k", 0.00158};

struct Figures {
  double nodes = 0, surface = 0, seconds = 0, cpu_seconds = 0, float_bytes = 0, right_sides = 0;
  double factor_bytes = 0, stored_bytes = 0, encode_seconds = 0, error = 0, shift = 0;
  ResultHash hash;
};

[[noreturn]] void exit_with(const Issue& issue) {
  std::fprintf(stderr, "%s\n", format_issue(issue).c_str());
  std::exit(exit_code(issue.code));
}

template <class T>
T value_or_exit(Result<T> result) {
  if (!result) exit_with(result.issue());
  return std::move(*result);
}

rusage usage() {
  rusage result{};
  getrusage(RUSAGE_SELF, &result);
  return result;
}

double cpu_seconds() {
  const rusage now = usage();
  return double(now.ru_utime.tv_sec + now.ru_stime.tv_sec) +
         1e-6 * double(now.ru_utime.tv_usec + now.ru_stime.tv_usec);
}

TetMesh graded_bunny(double edge_length_m) {
  const char* folder = std::getenv("SOUPLE_DATA_DIR");
  ImportOptions import;
  import.size_m = 0.2;
  const auto imported = value_or_exit(import_surface(
      std::string(folder ? folder : SOUPLE_DEFAULT_DATA_DIR) + "/surfaces/Bunny.stl", import));
  const auto closed = value_or_exit(orient_closed_surface(imported.mesh));
  TetrahedralizeOptions options;
  options.edge_length_m = edge_length_m;
  options.interior_coarsening = coarsening;
  TetMesh mesh = value_or_exit(tetrahedralize(closed.mesh, options)).mesh;
  Point low = mesh.nodes[0], high = low;
  for (const Point& p : mesh.nodes)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  const double scale = diagonal_m / (as_vec3(high) - as_vec3(low)).norm();
  for (Point& p : mesh.nodes)
    for (double& value : p) value *= scale;
  return mesh;
}

Material reference_material() {
  Material material;  // E 1e4 Pa, nu 0.4, 1000 kg/m3, alpha 0.1, beta 0.01
  material.regions.emplace_back();
  return material;
}

void store(const CompressedBySolves& compressed, Figures& figures) {
  EncodeOptions options;
  options.tolerance = tolerance;
  figures.encode_seconds = seconds_of([&] {
    const auto encoded =
        value_or_exit(encode_hierarchical(compressed.matrix, *compressed.exact, options));
    figures.stored_bytes = double(encoded.payload.size());
    figures.error = encoded.error.scaled_spectral;
    figures.shift = encoded.shift;
  });
}

Figures run(const Case& c) {
  const TetMesh mesh = graded_bunny(c.edge_length_m);
  const auto model = value_or_exit(CorotationalModel::create(mesh, reference_material()));
  BlockMatrix a0(model.pattern());
  model.assemble_rest(mass_factor, stiffness_factor, a0);
  std::vector<Index> all(mesh.nodes.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = Index(k);
  const std::vector<Index> surface = used_nodes(boundary_triangles(mesh.tets));
  std::vector<Point> positions;
  for (const Index node : surface) positions.push_back(mesh.nodes[std::size_t(node)]);

  Figures figures;
  figures.nodes = double(all.size());
  figures.surface = double(surface.size());
  SolveCompressionOptions options;
  options.tolerance = tolerance;
  const double cpu = cpu_seconds();
  CompressedBySolves compressed;
  figures.seconds = seconds_of(
      [&] { compressed = value_or_exit(compress_by_solves(a0, all, surface, positions, options)); });
  figures.cpu_seconds = cpu_seconds() - cpu;
  figures.right_sides = double(compressed.report.right_sides);
  figures.factor_bytes = double(compressed.report.factor_bytes);
  for (const LowRankBlock& block : compressed.matrix.blocks) {
    figures.float_bytes += 4.0 * double(block.left.size() + block.right.size() + block.singular.size());
    figures.hash.add(std::span(block.singular.data(), std::size_t(block.singular.size())));
  }
  for (const Eigen::MatrixXf& leaf : compressed.matrix.leaves)
    figures.float_bytes += 2.0 * double(leaf.size());
  std::fprintf(stderr, "%s: %.0f nodes, %.0f at the surface, ranks", c.name, figures.nodes,
               figures.surface);
  for (const Index rank : compressed.report.level_rank) std::fprintf(stderr, " %d", int(rank));
  std::fprintf(stderr, "; planned %zu MB, factor %zu MB\n", compressed.report.planned_bytes / 1000000,
               compressed.report.factor_bytes / 1000000);
  store(compressed, figures);
  return figures;
}

void print(const Case& c, const Figures& f) {
  const std::string name = std::string("by_solves.") + c.name;
  const double pairs = f.surface * f.surface;
  print_row(name + ".nodes", "", f.nodes, f.hash);
  print_row(name + ".surface", "", f.surface, f.hash);
  print_row(name + ".seconds", "s", f.seconds, f.hash);
  print_row(name + ".cpu_seconds", "s", f.cpu_seconds, f.hash);
  print_row(name + ".right_sides", "", f.right_sides, f.hash);
  print_row(name + ".float_bytes_per_pair", "B", f.float_bytes / pairs, f.hash);
  print_row(name + ".factor_bytes", "B", f.factor_bytes, f.hash);
  print_row(name + ".bytes_per_pair", "B", f.stored_bytes / pairs, f.hash);
  print_row(name + ".encode_seconds", "s", f.encode_seconds, f.hash);
  print_row(name + ".whole_seconds", "s", f.seconds + f.encode_seconds, f.hash);
  print_row(name + ".error", "", f.error, f.hash);
  print_row(name + ".shift", "", f.shift, f.hash);
}

void print_exponents(const std::string& name, const Figures& a, const Figures& b) {
  const double growth = std::log(b.surface / a.surface);
  print_row(name + ".time_exponent", "", std::log(b.cpu_seconds / a.cpu_seconds) / growth, b.hash);
  print_row(name + ".float_bytes_exponent", "", std::log(b.float_bytes / a.float_bytes) / growth,
            b.hash);
  print_row(name + ".bytes_exponent", "", std::log(b.stored_bytes / a.stored_bytes) / growth, b.hash);
  print_row(name + ".factor_exponent", "", std::log(b.factor_bytes / a.factor_bytes) / growth, b.hash);
}

int run(bool large) {
  const Figures first = run(small_case);
  const Case& second_case = large ? large_case : middle_case;
  const Figures second = run(second_case);
  if (!large) print(small_case, first);
  print(second_case, second);
  print_exponents(std::string("by_solves.3k_to_") + second_case.name, first, second);
  if (large)
    print_row("by_solves.50k.peak", "GiB", double(usage().ru_maxrss) / double(1 << 20), second.hash);
  return 0;
}

}  // namespace
}  // namespace souple::bench

int main(int argument_count, char** arguments) {
  return souple::bench::run(argument_count > 1 && std::strcmp(arguments[1], "large") == 0);
}
