// SPDX-License-Identifier: GPL-3.0-or-later
// Whether multigrid needs more iterations on a finer mesh. A liver held at one side, twisted by a
// radian, on hierarchies of three kinds: fitted (red refinements of a coarse mesh, midpoints moved to
// the surface), embedded (independent meshes) and lattice (the mesh alone; the levels are lattices
// around it). Static: K; dynamic: the matrix of a step of 0.01 s. To 1e-8 of the weight, from zero.
//
//   souple_bench_multigrid_iterations sizes          10k to 500k tets
//   souple_bench_multigrid_iterations million FILE   a step of a million; writes its asset to FILE
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/multigrid/multigrid_preconditioner.hpp"
#include "runtime/solve/step_solver.hpp"
#include "runtime/world/integrator.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/free_motion_bodies.hpp"
#include "tests/bench/multigrid_million.hpp"
#include "tests/bench/row.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/hierarchy/embedded_hierarchy.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

struct Size {
  std::string name;
  std::size_t tets;
  int level_count;
};

/// Coarsest meshes of about a thousand tets.
const std::vector<Size> sizes{{"10k", 10000, 2}, {"70k", 70000, 3}, {"500k", 500000, 4}};

/// A matrix on the nodes that move, and a right side.
struct System {
  std::unique_ptr<const CorotationalModel> model;
  std::unique_ptr<BlockMatrix> a;
  Eigen::VectorXd b;
};

Eigen::VectorXd twisted(std::span<const Point> rest) {
  const auto [least, most] = std::ranges::minmax_element(rest, {}, [](const Point& p) { return p[0]; });
  Eigen::VectorXd x(3 * Eigen::Index(rest.size()));
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double place = (rest[i][0] - (*least)[0]) / ((*most)[0] - (*least)[0]);
    node_entry(x, Index(i)) = Eigen::AngleAxisd(place, Vec3::UnitX()) * as_vec3(rest[i]);
  }
  return x;
}

System make_system(const TetMesh& mesh, std::span<const Index> fixed, double poisson,
                   Integrator integrator) {
  System system;
  system.model = std::make_unique<const CorotationalModel>(
      value_or_exit(CorotationalModel::create(mesh, test::material_of(1e4, poisson, 1000, 0.1, 0.01))));
  const CorotationalModel& model = *system.model;
  const SystemFactors factors = system_factors(integrator, 0.01, 0.1, 0.01);
  std::vector<Mat3> rotations;
  model.element_rotations(twisted(model.rest_positions()), rotations);
  system.a = std::make_unique<BlockMatrix>(model.pattern());
  model.assemble(factors.mass, factors.stiffness, rotations, *system.a);
  std::vector<char> is_held(std::size_t(model.node_count()), 0);
  for (const Index node : fixed) is_held[std::size_t(node)] = 1;
  model.hold_nodes(is_held, *system.a);
  system.b.setZero(3 * model.node_count());
  for (Index i = 0; i < model.node_count(); ++i)
    if (!is_held[std::size_t(i)])
      node_entry(system.b, i) = -9.81 * model.masses()[std::size_t(i)] * Vec3::UnitZ();
  return system;
}

struct Figures {
  int iterations = 0;
  double work = 0;         ///< iterations times their work units, products with A
  double contraction = 1;  ///< of the energy norm of the error, by a cycle alone
};

/// Of the last cycles of many, where the slowest error is left.
double contraction_of(Preconditioner& cycle, const System& system) {
  constexpr int cycle_count = 30, last = 5;
  Eigen::VectorXd error = Eigen::VectorXd::Random(system.b.size()), residual(error.size()),
                  correction(error.size());
  std::vector<double> energy;
  for (int k = 0; k <= cycle_count; ++k) {
    multiply(*system.a, error, residual);
    energy.push_back(error.dot(residual));
    cycle.apply(residual, correction);
    error -= correction;
  }
  return std::pow(energy.back() / energy[energy.size() - 1 - last], 0.5 / last);
}

Figures measure(const System& system, std::shared_ptr<const MultigridHierarchy> hierarchy, int sweeps) {
  const Index node_count = system.model->node_count();
  Figures figures;
  StepSolver solver(Iteration::conjugate_gradient,
                    std::make_unique<MultigridPreconditioner>(hierarchy, sweeps), node_count);
  solver.set_system({system.a.get(), {}});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.b.size());
  const SolveReport report = solver.solve(system.b, {1e-8, system.b.norm(), 500}, x);
  // What does not converge shows as a figure that no target admits.
  figures.iterations = report.converged ? report.iterations : 1000000;
  figures.work = figures.iterations * solver.work_units();
  MultigridPreconditioner cycle(hierarchy, sweeps);
  if (cycle.update({system.a.get(), {}})) figures.contraction = contraction_of(cycle, system);
  return figures;
}

/// The finest mesh of `fitted` over independent meshes of an eighth of the tets, and so on.
std::vector<MeshLevel> embedded_levels(const HeldBody& fitted) {
  ImportOptions import;
  import.size_m = 0.2;
  const TriangleMesh surface =
      value_or_exit(
          orient_closed_surface(
              value_or_exit(import_surface(data_folder() / "surfaces/liver-smooth.obj", import)).mesh))
          .mesh;
  std::vector<TetMesh> meshes(fitted.levels.size());
  meshes.back() = fitted.levels.back().mesh;
  std::size_t tets = meshes.back().tets.size();
  for (std::size_t l = meshes.size() - 1; l-- > 0;) {
    TetrahedralizeOptions options;
    options.target_tet_count = tets /= 8;
    meshes[l] = value_or_exit(tetrahedralize(surface, options)).mesh;
  }
  return value_or_exit(build_embedded_hierarchy(meshes, surface)).levels;
}

/// By hierarchy, mode, Poisson's ratio and sweeps, from small to large.
using Growth = std::map<std::string, std::vector<Figures>>;

void measure_size(const Size& size, Growth& growth) {
  const HeldBody held = held_surface("liver-smooth.obj", size.tets, size.level_count);
  const std::span<const Index> fixed = held.asset->find_fixed_set(held_set)->nodes;
  const std::vector<MeshLevel> only(held.levels.end() - 1, held.levels.end());
  const std::vector<MeshLevel> embedded = embedded_levels(held);
  const std::pair<const char*, const std::vector<MeshLevel>*> kinds[] = {
      {"fitted", &held.levels}, {"embedded", &embedded}, {"lattice", &only}};
  for (const auto& [kind, levels] : kinds) {
    const auto hierarchy = std::make_shared<const MultigridHierarchy>(
        value_or_exit(MultigridHierarchy::create(*levels, held.asset->model().pattern(), fixed)));
    for (const double poisson : {0.4, 0.45})
      for (const Integrator integrator : {Integrator::quasi_static, Integrator::implicit_euler}) {
        const System system = make_system(levels->back().mesh, fixed, poisson, integrator);
        const std::string name = std::string(kind) +
                                 (integrator == Integrator::quasi_static ? "_static" : "_dynamic") +
                                 (poisson == 0.4 ? "_nu40" : "_nu45");
        for (const int sweeps : {1, 2}) {
          const Figures figures = measure(system, hierarchy, sweeps);
          growth[name + "_v" + std::to_string(sweeps)].push_back(figures);
          std::printf(
              "# %-22s %7zu tets, %zu levels, %d sweeps: %3d iterations, %6.1f work units, contraction "
              "%.3f\n",
              name.c_str(), levels->back().mesh.tets.size(), hierarchy->level_count(), sweeps,
              figures.iterations, figures.work, figures.contraction);
          std::fflush(stdout);
        }
      }
  }
}

void all_sizes() {
  Growth growth;
  for (const Size& size : sizes) measure_size(size, growth);
  for (const auto& [name, figures] : growth) {
    int most = 0;
    for (const Figures& f : figures) most = std::max(most, f.iterations);
    const std::string row = "multigrid." + name;
    print_row(row + "_growth", "count", most - figures.front().iterations, ResultHash{});
    print_row(row + "_iterations", "count", figures.back().iterations, ResultHash{});
    print_row(row + "_work", "count", figures.back().work, ResultHash{});
    print_row(row + "_contraction", "1", figures.back().contraction, ResultHash{});
  }
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** arguments) {
  if (count == 2 && std::strcmp(arguments[1], "sizes") == 0) {
    souple::bench::all_sizes();
  } else if (count == 3 && std::strcmp(arguments[1], "million") == 0) {
    souple::bench::step_a_million(arguments[2]);
  } else {
    std::fprintf(stderr, "usage: %s sizes | million FILE\n", arguments[0]);
    return 1;
  }
}
