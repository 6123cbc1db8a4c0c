// SPDX-License-Identifier: GPL-3.0-or-later
// The thesis's figures 4.16 and 4.17: the condition of the preconditioned matrix of a torus of about
// 1470 tets that falls and rolls, and the iterations of conjugate gradients, step by step, without a
// preconditioner, with the diagonal, the rest matrix as it is, and the warped rest matrix. Then the
// cantilever of 6480 tets, bent by its weight.
//
//   souple_bench_warped_preconditioner [FOLDER]   writes the plots there
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "runtime/solve/block_jacobi.hpp"
#include "runtime/solve/rest_factor.hpp"
#include "runtime/solve/step_solver.hpp"
#include "runtime/solve/warped_preconditioner.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "runtime/world/world.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/line_plot.hpp"
#include "tests/bench/row.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple::bench {
namespace {

constexpr double mass_factor = 1e4 + 10, stiffness_factor = 2;  // h 0.01 s, alpha 0.1, beta 0.01

/// A square of 3 x 3 cells pressed into a disc, 27 times around: 1458 tets, axis along y. Its outer
/// diameter is 0.16 m, so that the diagonal of its box is 0.23 m.
TetMesh torus() {
  constexpr int slices = 27, cells = 3, side = cells + 1;
  constexpr double ring = 0.056, tube = 0.024;
  TetMesh mesh;
  for (int s = 0; s < slices; ++s)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const double u = 2.0 * i / cells - 1, v = 2.0 * j / cells - 1;
        const double a = tube * u * std::sqrt(1 - v * v / 2), b = tube * v * std::sqrt(1 - u * u / 2);
        const double angle = 2 * std::numbers::pi * s / slices;
        mesh.nodes.push_back({(ring + a) * std::cos(angle), b, (ring + a) * std::sin(angle)});
      }
  const auto node = [&](int i, int j, int s) {
    return Index((s % slices) * side * side + j * side + i);
  };
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int s = 0; s < slices; ++s)
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i)
        for (const auto& order : orders) {
          std::array<int, 3> at{i, j, s};
          Tet tet;
          tet[0] = node(at[0], at[1], at[2]);
          for (std::size_t k = 0; k < 3; ++k) {
            ++at[std::size_t(order[k])];
            tet[k + 1] = node(at[0], at[1], at[2]);
          }
          if (signed_volume6(mesh.nodes[std::size_t(tet[0])], mesh.nodes[std::size_t(tet[1])],
                             mesh.nodes[std::size_t(tet[2])], mesh.nodes[std::size_t(tet[3])]) < 0)
            std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
  return mesh;
}

std::shared_ptr<const SoftBodyAsset> body_of(TetMesh mesh, double young_pa = 1e4,
                                             std::vector<FixedSet> fixed = {}) {
  SoftBodyContent content;
  content.level = test::level_of(std::move(mesh));
  content.material = test::material_of(young_pa, 0.4, 1000, 0.1, 0.01);
  content.fixed_sets = std::move(fixed);
  return value_or_exit(SoftBodyAsset::create(std::move(content)));
}

class Identity final : public Preconditioner {
 public:
  bool update(const StepSystem&) override { return true; }
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override { z = r; }
  double work_units() const override { return 0; }
  std::size_t bytes() const override { return 0; }
};

/// The matrix of a shape and what preconditions it.
class Measure {
 public:
  Measure(const CorotationalModel& model, std::vector<char> is_held)
      : model_(model), is_held_(std::move(is_held)), a_(model.pattern()) {
    for (Index node = 0; node < model.node_count(); ++node)
      if (!is_held_[std::size_t(node)]) free_.push_back(node);
    factor_ = std::make_shared<const RestFactor>(
        value_or_exit(RestFactor::create(model, mass_factor, stiffness_factor, free_)));
  }

  static constexpr std::array<const char*, 4> names{"none", "Jacobi", "rest matrix A0",
                                                    "warped R A0 R^T"};

  std::unique_ptr<Preconditioner> make(std::size_t kind) const {
    auto rest = std::make_unique<RestFactorPreconditioner>(factor_);
    if (kind == 0) return std::make_unique<Identity>();
    if (kind == 1) return std::make_unique<BlockJacobi>(model_.node_count());
    if (kind == 2) return rest;
    return std::make_unique<WarpedPreconditioner>(std::move(rest), model_.node_count());
  }

  void take(std::span<const Point> x) {
    const Eigen::VectorXd shape =
        Eigen::Map<const Eigen::VectorXd>(x[0].data(), Eigen::Index(3 * x.size()));
    std::vector<Mat3> elements;
    model_.element_rotations(shape, elements);
    model_.node_rotations(elements, rotations_);
    model_.assemble(mass_factor, stiffness_factor, elements, a_);
    model_.hold_nodes(is_held_, a_);
    weight_.setZero(shape.size());
    for (const Index node : free_)
      node_entry(weight_, node) = model_.masses()[std::size_t(node)] * Vec3(0, 0, -9.81);
    model_.add_elastic_forces(shape, elements, weight_);
    for (std::size_t node = 0; node < is_held_.size(); ++node)
      if (is_held_[node]) node_entry(weight_, Index(node)).setZero();
  }

  /// To a relative residual of 1e-6, from zero, of the forces of gravity and elasticity.
  int iterations(std::size_t kind) const {
    StepSolver solver(Iteration::conjugate_gradient, make(kind), model_.node_count());
    solver.set_system({&a_, rotations_});
    Eigen::VectorXd x = Eigen::VectorXd::Zero(weight_.size());
    return solver.solve(weight_, {1e-6, weight_.norm(), 5000}, x).iterations;
  }

  /// Largest over least eigenvalue of M^-1 A, from the Lanczos matrix of conjugate gradients on a right
  /// side that has all directions. Residuals are kept orthogonal to all before: no ghost eigenvalues.
  double condition(std::size_t kind) const {
    constexpr int most = 400;
    auto m = make(kind);
    if (!m->update({&a_, rotations_})) return 0;
    Eigen::VectorXd r(weight_.size()), z(r.size()), p, q(r.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) r[i] = std::sin(1.3 * double(i) + 0.5) + 0.3;
    for (std::size_t node = 0; node < is_held_.size(); ++node)
      if (is_held_[node]) node_entry(r, Index(node)).setZero();
    std::vector<double> diagonal, beside;
    std::vector<Eigen::VectorXd> residuals, answers;
    double rho_last = 0, alpha_last = 0;
    const double start = r.norm();
    for (int k = 0; k < most && r.norm() > 1e-13 * start; ++k) {
      m->apply(r, z);
      for (std::size_t j = 0; j < residuals.size(); ++j) {
        const double share = z.dot(residuals[j]);
        r -= share * residuals[j];
        z -= share * answers[j];
      }
      const double rho = r.dot(z);
      if (!(rho > 0)) break;
      const double beta = k > 0 ? rho / rho_last : 0;
      p = k > 0 ? Eigen::VectorXd(z + beta * p) : z;
      multiply(a_, p, q);
      const double alpha = rho / p.dot(q);
      diagonal.push_back(1 / alpha + (k > 0 ? beta / alpha_last : 0));
      if (k > 0) beside.push_back(std::sqrt(beta) / alpha_last);
      residuals.push_back(r / std::sqrt(rho));
      answers.push_back(z / std::sqrt(rho));
      r -= alpha * q;
      rho_last = rho;
      alpha_last = alpha;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
    eigen.computeFromTridiagonal(
        Eigen::Map<Eigen::VectorXd>(diagonal.data(), Eigen::Index(diagonal.size())),
        Eigen::Map<Eigen::VectorXd>(beside.data(), Eigen::Index(beside.size())),
        Eigen::EigenvaluesOnly);
    return eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
  }

 private:
  const CorotationalModel& model_;
  std::vector<char> is_held_;
  std::vector<Index> free_;
  std::shared_ptr<const RestFactor> factor_;
  BlockMatrix a_;
  std::vector<Mat3> rotations_;
  Eigen::VectorXd weight_;
};

/// A wheel that falls from 5 cm onto a floor with a forward speed, lands and rolls.
void roll(const std::filesystem::path& folder) {
  const auto asset = body_of(torus());
  WorldSettings settings;
  settings.contact_method = ContactMethod::exact;
  settings.friction = 0.8;
  World world = value_or_exit(World::create(settings));
  RigidBodyDescription floor;
  floor.name = "floor";
  floor.path.push_back({});
  value_or_exit(world.add_rigid_body(floor));
  SoftBodyDescription description;
  description.name = "torus";
  description.pose.translation = {0, 0, 0.13};
  description.velocity_m_s = {0.8, 0, 0};
  description.angular_velocity_rad_s = {0, 6, 0};
  const BodyId torus_id = value_or_exit(world.add_soft_body(asset, description));
  Measure measure(asset->model(), std::vector<char>(std::size_t(asset->model().node_count()), 0));
  Plot conditions{"condition of the preconditioned matrix, torus falling and rolling",
                  "step",
                  "largest over least eigenvalue",
                  false,
                  {}};
  Plot counts{"iterations of conjugate gradients to 1e-6", "step", "iterations", false, {}};
  for (const char* name : Measure::names) {
    conditions.series.push_back({name, {}});
    counts.series.push_back({name, {}});
  }
  std::array<std::vector<double>, 4> condition, count;
  ResultHash hash;
  constexpr int steps = 150, stride = 5;
  for (int step = 0; step <= steps; ++step) {
    if (step % stride == 0) {
      measure.take(world.positions(torus_id));
      for (std::size_t kind = 0; kind < Measure::names.size(); ++kind) {
        condition[kind].push_back(measure.condition(kind));
        count[kind].push_back(measure.iterations(kind));
        conditions.series[kind].points.emplace_back(step, condition[kind].back());
        counts.series[kind].points.emplace_back(step, count[kind].back());
      }
    }
    value_or_exit(world.step());
  }
  hash.add(world.positions(torus_id));
  std::vector<double> gain, fewer;
  for (std::size_t k = 0; k < condition[0].size(); ++k) {
    gain.push_back(condition[0][k] / condition[3][k]);
    fewer.push_back(count[1][k] / count[3][k]);
  }
  const auto worst = [](const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); };
  const auto least = [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); };
  print_row("warped.torus_condition_gain", "ratio", least(gain), hash);
  print_row("warped.torus_condition_gain_median", "ratio", median(gain), hash);
  print_row("warped.torus_condition_worst", "ratio", worst(condition[3]), hash);
  print_row("warped.torus_condition_spread", "ratio", worst(condition[3]) / median(condition[3]), hash);
  print_row("warped.torus_plain_condition_worst", "ratio", worst(condition[2]), hash);
  print_row("warped.torus_none_condition", "ratio", median(condition[0]), hash);
  print_row("warped.torus_fewer_than_jacobi", "ratio", least(fewer), hash);
  print_row("warped.torus_iterations_worst", "count", worst(count[3]), hash);
  print_row("warped.torus_plain_iterations_worst", "count", worst(count[2]), hash);
  write_plot(conditions, folder / "warped_condition.svg");
  write_plot(counts, folder / "warped_iterations.svg");
}

/// 6480 tets, held at one end and bent by its weight for 0.4 s: at 1e6 Pa by a twelfth of its length,
/// at 1e4 Pa until it hangs.
void bend(double young_pa, const std::string& name) {
  TetMesh mesh = test::box_mesh({30, 6, 6}, {0, 0, 0}, {0.19, 0.038, 0.038});
  FixedSet wall{"wall", {}};
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (mesh.nodes[node][0] == 0) wall.nodes.push_back(Index(node));
  std::vector<char> is_held(mesh.nodes.size(), 0);
  for (const Index node : wall.nodes) is_held[std::size_t(node)] = 1;
  const auto asset = body_of(std::move(mesh), young_pa, {wall});
  WorldSettings settings;
  settings.contact_method = ContactMethod::exact;
  World world = value_or_exit(World::create(settings));
  SoftBodyDescription description;
  description.name = "cantilever";
  description.fixed_set = "wall";
  const BodyId beam = value_or_exit(world.add_soft_body(asset, description));
  for (int step = 0; step < 40; ++step) value_or_exit(world.step());
  Measure measure(asset->model(), is_held);
  measure.take(world.positions(beam));
  ResultHash hash;
  hash.add(world.positions(beam));
  const std::array<const char*, 4> rows{"none", "jacobi", "plain", "warped"};
  for (std::size_t kind = 0; kind < rows.size(); ++kind)
    print_row("warped." + name + "_iterations_" + rows[kind], "count", measure.iterations(kind), hash);
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** arguments) {
  const std::filesystem::path folder = count > 1 ? arguments[1] : ".";
  std::filesystem::create_directories(folder);
  souple::bench::roll(folder);
  souple::bench::bend(1e6, "cantilever");
  souple::bench::bend(1e4, "hanging_bar");
}
