// SPDX-License-Identifier: GPL-3.0-or-later
// The rest compliance of real bodies: time of the Gram form against solves with blocks of columns, its
// share of the machine's own rate of matrix products, and what a whole stage takes.
//
// Usage: compliance_precompute [middle | small | large]…; `large` wants 6 GB and a quiet machine.
#include <sys/resource.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "runtime/fem/corotational_model.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tools/compliance/blas_calls.hpp"
#include "tools/compliance/precompute.hpp"
#include "tools/compliance/surface_gram.hpp"
#include "tools/compliance/worker_pool.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/repair.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

constexpr unsigned threads = 2;
constexpr double time_step_s = 0.01;

/// Diagonal of the bounding box 0.2 m, as in all trials.
MeshLevel body_of(const char* file, std::size_t tets) {
  ImportOptions import;
  import.size_m = 0.2;
  const auto surface = value_or_exit(import_surface(data_folder() / "surfaces" / file, import)).mesh;
  const auto repaired = value_or_exit(repair_surface(surface, {}));
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  MeshLevel level;
  level.mesh = value_or_exit(tetrahedralize(repaired.mesh, options)).mesh;
  level.boundary = boundary_triangles(level.mesh.tets);
  Eigen::AlignedBox3d box;
  for (const Point& p : level.mesh.nodes) box.extend(as_vec3(p));
  const double scale = 0.2 / box.diagonal().norm();
  for (Point& p : level.mesh.nodes)
    for (double& x : p) x *= scale;
  std::fprintf(stderr, "%s: %zu nodes, %zu on the surface, %zu tets\n", file, level.mesh.nodes.size(),
               used_nodes(level.boundary).size(), level.mesh.tets.size());
  return level;
}

Material soft() {
  Material material;
  material.regions.push_back({"all", 1e4, 0.4, 1000});
  material.rayleigh_mass_per_s = 0.1;
  material.rayleigh_stiffness_s = 0.01;
  return material;
}

/// Everything from the mesh on.
struct Run {
  double total_s = 0, factor_s = 0, gram_s = 0, cpu_s = 0;
  GramReport report;
  ResultHash hash;
};

double cpu_seconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-6 * double(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

SupernodalFactor factor_of(const MeshLevel& level, std::vector<Index>& nodes) {
  const auto model = value_or_exit(CorotationalModel::create(level.mesh, soft()));
  BlockMatrix a0(model.pattern());
  model.assemble_rest(1 / (time_step_s * time_step_s) + 0.1 / time_step_s, 1 + 0.01 / time_step_s, a0);
  nodes.resize(level.mesh.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  const auto surface = used_nodes(level.boundary);
  FactorOptions options;
  options.threads = threads;
  options.surface = surface;
  return value_or_exit(SupernodalFactor::create(a0, nodes, options));
}

template <class Scalar>
Run run_gram(const MeshLevel& level) {
  Run run;
  const double cpu = cpu_seconds();
  run.total_s = seconds_of([&] {
    std::vector<Index> nodes;
    std::optional<SupernodalFactor> factor;
    run.factor_s = seconds_of([&] { factor.emplace(factor_of(level, nodes)); });
    GramOptions options;
    options.threads = threads;
    std::unique_ptr<SurfaceGram<Scalar>> gram;
    run.gram_s = seconds_of([&] {
      gram = value_or_exit(SurfaceGram<Scalar>::create(*factor, used_nodes(level.boundary), options));
    });
    run.report = gram->report();
    Eigen::MatrixXd sample(3, 3 * gram->node_count());
    std::vector<Index> rows(std::size_t(gram->node_count()));
    std::iota(rows.begin(), rows.end(), 0);
    gram->read(std::span(rows).first(1), rows, sample);
    run.hash.add(std::span<const double>(sample.data(), std::size_t(sample.size())));
  });
  run.cpu_s = cpu_seconds() - cpu;
  return run;
}

/// What products alone reach on all threads, flops per second.
template <class Scalar>
double product_rate() {
  constexpr std::int64_t n = 768;
  constexpr std::size_t count = 96;
  std::vector<std::vector<Scalar>> c(count, std::vector<Scalar>(n * n));
  const std::vector<Scalar> a(n * n, Scalar(1e-3));
  WorkerPool pool(threads);
  const auto work = [&](std::size_t item, unsigned) {
    blas::add_transposed_product(n, n, n, a.data(), n, a.data(), n, c[item].data(), n);
  };
  const auto seconds = repeated_seconds(3, [&] { pool.run(count, work); });
  return 2.0 * n * n * n * double(count) / *std::ranges::min_element(seconds);
}

/// Seconds that blocks of 128 columns would take for all of them, on one thread: three blocks are
/// timed.
double column_blocks_seconds(const MeshLevel& level) {
  constexpr std::size_t width = 128, timed = 3;
  std::vector<Index> nodes;
  const SupernodalFactor factor = factor_of(level, nodes);
  const auto surface = used_nodes(level.boundary);
  SupernodalFactor::Workspace workspace(factor, width);
  std::vector<double> seconds;
  for (std::size_t block = 0; block < timed; ++block)
    seconds.push_back(seconds_of([&] {
      std::ranges::fill(workspace.right_sides(), 0.0);
      for (std::size_t k = 0; k < width; ++k) {
        const std::size_t column = (block * width + k) % (3 * surface.size());
        workspace.right_sides()[k * factor.size() + 3 * std::size_t(surface[column / 3]) + column % 3] =
            1;
      }
      (void)factor.solve(workspace, width);
    }));
  return median(seconds) * 3 * double(surface.size()) / double(width);
}

template <class Scalar>
void time_middle(const MeshLevel& level, const std::string& name, double blocks_s) {
  std::vector<double> total, cpu, share, ratio;
  Run run;
  for (int k = 0; k < 3; ++k) {
    run = run_gram<Scalar>(level);
    total.push_back(run.total_s);
    cpu.push_back(run.cpu_s);
    ratio.push_back(blocks_s / run.total_s);
    share.push_back(100 * (run.report.solve_flops + run.report.product_flops) / run.gram_s /
                    product_rate<Scalar>());
  }
  std::fprintf(stderr, "%s: factor %.2f s, Gram form %.2f s, cpu %.2f s, %.0f + %.0f GFlop\n",
               name.c_str(), run.factor_s, run.gram_s, run.cpu_s, run.report.solve_flops * 1e-9,
               run.report.product_flops * 1e-9);
  print_row("compliance.middle." + name, "s", total, run.hash);
  print_row("compliance.middle." + name + "_cpu", "s", cpu, run.hash);
  print_row("compliance.middle." + name + "_share", "%", share, run.hash);
  print_row("compliance.middle." + name + "_ratio", "1", ratio, run.hash);
}

void middle() {
  const MeshLevel level = body_of("liver-smooth.obj", 60500);
  const double blocks_s = column_blocks_seconds(level);
  print_row("compliance.middle.column_blocks", "s", blocks_s, ResultHash());
  time_middle<double>(level, "double", blocks_s);
  time_middle<float>(level, "single", blocks_s);
}

void small() {
  const MeshLevel level = body_of("dino.off", 4300);
  CompliancePrecomputeOptions options;
  CompliancePrecomputeSettings settings;
  settings.threads = threads;
  ComplianceVariant variant;
  const auto seconds = repeated_seconds(5, [&] {
    variant = value_or_exit(precompute_compliance(level, nullptr, soft(), nullptr, options, settings));
  });
  ResultHash hash;
  hash.add(variant.payload);
  print_row("compliance.small.stage", "s", seconds, hash);
  print_row("compliance.small.payload", "MB", 1e-6 * double(variant.payload.size()), hash);
}

void large() {
  const MeshLevel level = body_of("liver-smooth.obj", 262000);
  const Run run = run_gram<float>(level);
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  std::fprintf(stderr, "large: factor %.1f s, Gram form %.1f s, cpu %.1f s\n", run.factor_s, run.gram_s,
               run.cpu_s);
  print_row("compliance.large.single", "s", run.total_s, run.hash);
  print_row("compliance.large.single_cpu", "s", run.cpu_s, run.hash);
  print_row("compliance.large.memory", "GB", 1.024e-6 * double(use.ru_maxrss), run.hash);
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** arguments) {
  using namespace souple::bench;
  souple::blas::use_one_thread_per_call();
  std::vector<std::string> parts(arguments + 1, arguments + count);
  if (parts.empty()) parts = {"middle", "small"};
  for (const std::string& part : parts) {
    if (part == "middle") middle();
    if (part == "small") small();
    if (part == "large") large();
  }
  return 0;
}
