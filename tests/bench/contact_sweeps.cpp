// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep of the contact solver costs and how many it takes, on W between 150 surface nodes of a
// baked liver: 40 or all of them bear a force. Beside the product stand a plain sweep (W in double,
// every gap summed anew) and the update form in double.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "runtime/compliance/contact_blocks.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/contact/delassus_operator.hpp"
#include "runtime/contact/dense_contact_operator.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tests/support/frictional_contact.hpp"

namespace {

using namespace souple;
using namespace souple::test;
using namespace souple::bench;

constexpr std::size_t contacts = 150;
constexpr double friction = 0.4;
constexpr int runs = 41;

struct Problem {
  std::vector<double> delassus, free_gap;  // m/N, m
  std::vector<double> friction = std::vector<double>(contacts, ::friction);
  FrictionalContactProblem view() const { return {contacts, delassus, free_gap, friction}; }
};

// The patch of 150 surface nodes nearest to one of them, and their distances from it in m.
struct Patch {
  std::vector<Index> rows;
  std::vector<double> distance;
};

Patch nearest_nodes(const SoftBodyAsset& body, const BodyCompliance& compliance) {
  const auto rest = body.model().rest_positions();
  const auto position = [&](Index row) {
    return as_vec3(rest[std::size_t(compliance.nodes[std::size_t(row)])]);
  };
  const Vec3 centre = position(100);
  std::vector<Index> rows(compliance.nodes.size());
  std::iota(rows.begin(), rows.end(), Index{0});
  std::ranges::sort(rows, {},
                    [&](Index row) { return std::pair((position(row) - centre).norm(), row); });
  rows.resize(contacts);
  std::ranges::sort(rows);
  Patch patch{rows, {}};
  for (const Index row : rows) patch.distance.push_back((position(row) - centre).norm());
  return patch;
}

// One common frame: the elastic coupling of the nodes is what makes the problem hard, not the frames.
std::vector<double> delassus_of(const RestCompliance& rest, const std::vector<Index>& rows) {
  ContactBlocks blocks;
  blocks.update(rest, rows);
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < contacts; ++i) touches.push_back({Index(i), Index(i), 1.0});
  const std::vector<Mat3> frames(contacts, contact_frame(Vec3(0.3, 0.2, 1).normalized())),
      rotations(contacts, Mat3::Identity());
  std::vector<double> delassus(9 * contacts * contacts);
  const DelassusTarget<double> w{delassus.data(), 3 * contacts};
  DelassusWork<float> work;
  add_to_delassus<float>({touches, frames, rotations},
                         {blocks.values(), blocks.stride(), blocks.slots()}, 1, w, work);
  mirror_delassus(contacts, w);
  return delassus;
}

std::size_t active_count(const std::vector<double>& force) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < contacts; ++i) count += force[3 * i] > 0 ? 1 : 0;
  return count;
}

std::vector<double> solution_of(const Problem& problem) {
  std::vector<double> force(3 * contacts), gap(3 * contacts);
  solve_frictional_contact(problem.view(), {1e-12, 100000}, force, gap);
  return force;
}

// A ball of radius `radius` m pressed in by `depth` m and drawn sideways by a third of it.
void press(const Patch& patch, double radius, double depth, Problem& problem) {
  problem.free_gap.resize(3 * contacts);
  for (std::size_t i = 0; i < contacts; ++i) {
    problem.free_gap[3 * i] = patch.distance[i] * patch.distance[i] / (2 * radius) - depth;
    problem.free_gap[3 * i + 1] = depth / 3;
    problem.free_gap[3 * i + 2] = 0;
  }
}

// Pressed until about `wanted` contacts bear a force.
void press_until(const Patch& patch, double radius, std::size_t wanted, Problem& problem) {
  double low = 0, high = 0.05;
  for (int k = 0; k < 30; ++k) {
    press(patch, radius, 0.5 * (low + high), problem);
    (active_count(solution_of(problem)) < wanted ? low : high) = 0.5 * (low + high);
  }
  press(patch, radius, high, problem);
}

// Every gap summed anew from W in double: what a sweep is without the update form.
void plain_sweep(const Problem& problem, const std::vector<LocalLaw>& laws,
                 std::vector<double>& force) {
  constexpr auto size = Eigen::Index(3 * contacts);
  const Eigen::Map<const Eigen::VectorXd> f(force.data(), size);
  for (std::size_t i = 0; i < contacts; ++i) {
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3>> rows(
        problem.delassus.data() + 9 * contacts * i, size, 3);
    const Vec3 gap = rows.transpose() * f + Eigen::Map<const Vec3>(&problem.free_gap[3 * i]);
    Eigen::Map<Vec3> own(&force[3 * i]);
    own = laws[i].next_force(gap, own);
  }
}

// The gap after the next step of a slow motion: 2 % more depth and slip.
Problem next_step(const Problem& problem) {
  Problem next = problem;
  for (std::size_t i = 0; i < contacts; ++i) {
    next.free_gap[3 * i] -= 0.02 * std::abs(problem.free_gap[3 * i]);
    next.free_gap[3 * i + 1] *= 1.02;
  }
  return next;
}

void time_sweeps(const std::string& name, const Problem& problem, ResultHash& hash) {
  constexpr int sweeps = 64;
  const std::vector<ConstraintLaw> laws(contacts, {ConstraintLaw::Kind::frictional, friction});
  DenseContactOperator op;
  op.assign(problem.delassus, problem.free_gap);
  GaussSeidelWork work;
  std::vector<double> force = solution_of(problem), gap(3 * contacts);
  const std::vector<double> solution = force;
  // From a solution times 0.9 no force stands still in so few sweeps: every active contact is updated.
  const auto timed = [&](auto&& sweep_many) {
    std::vector<double> seconds;
    for (int run = 0; run < runs; ++run) {
      for (std::size_t k = 0; k < force.size(); ++k) force[k] = 0.9 * solution[k];
      seconds.push_back(sweep_many() / sweeps);
    }
    hash.add(force);
    return seconds;
  };
  const auto product = timed([&] {
    gauss_seidel::start(op, laws, force, work);
    gauss_seidel::sweep_all(op, work, force);
    return seconds_of([&] {
      for (int k = 0; k < sweeps; ++k)
        k % 8 == 0 ? gauss_seidel::sweep_all(op, work, force)
                   : gauss_seidel::sweep_active(op, work, force);
    });
  });
  print_row("contact_sweeps." + name + ".sweep", "us", product, hash, 1e6);
  const auto in_double = timed([&] {
    return seconds_of([&] { solve_frictional_contact(problem.view(), {0, sweeps}, force, gap); });
  });
  print_row("contact_sweeps." + name + ".sweep_double", "us", in_double, hash, 1e6);
  const auto plain = timed([&] {
    return seconds_of([&] {
      for (int k = 0; k < sweeps; ++k) plain_sweep(problem, work.laws, force);
    });
  });
  print_row("contact_sweeps." + name + ".sweep_plain", "us", plain, hash, 1e6);
}

void time_solves(const std::string& name, const Problem& problem, ResultHash& hash) {
  const std::vector<ConstraintLaw> laws(contacts, {ConstraintLaw::Kind::frictional, friction});
  const Problem next = next_step(problem);
  DenseContactOperator op;
  op.assign(next.delassus, next.free_gap);
  GaussSeidelWork work;
  const std::vector<double> last = solution_of(problem);
  for (const double tolerance : {1e-6, 1e-8})
    for (const bool warm : {true, false}) {
      std::vector<double> force, seconds;
      ContactSolveReport report;
      for (int run = 0; run < runs; ++run) {
        force = warm ? last : std::vector<double>(3 * contacts);
        seconds.push_back(seconds_of([&] {
          report = solve_by_gauss_seidel(op, laws, {tolerance, 1000}, force, work);
        }));
      }
      hash.add(force);
      const std::string row =
          "contact_sweeps." + name + (warm ? ".warm" : ".cold") + (tolerance == 1e-6 ? "" : "_tight");
      print_row(row, "ms", seconds, hash, 1e3);
      print_row(row + ".sweeps", "1", double(report.sweeps), hash);
      print_row(row + ".residual", "1", natural_map_residual(next.view(), force), hash);
    }
}

}  // namespace

int main() {
  const auto liver = baked_liver(24000, 1);
  const BodyCompliance& compliance = liver->compliances()[0];
  const Patch patch = nearest_nodes(*liver, compliance);
  ResultHash hash;
  Problem some, all;
  all.delassus = some.delassus = delassus_of(*compliance.rest, patch.rows);
  press_until(patch, 0.03, 40, some);
  press(patch, 1e3, 0.01, all);
  print_row("contact_sweeps.some.active", "1", double(active_count(solution_of(some))), hash);
  print_row("contact_sweeps.all.active", "1", double(active_count(solution_of(all))), hash);
  for (const auto& [name, problem] :
       {std::pair<std::string, const Problem&>{"some", some}, {"all", all}}) {
    time_sweeps(name, problem, hash);
    time_solves(name, problem, hash);
  }
  return 0;
}
