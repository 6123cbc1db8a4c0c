// SPDX-License-Identifier: GPL-3.0-or-later
// The coarse matrices of one step (all levels below the finest), made in every way we know, in one run:
// thread time of one core, as in a step: the finest matrix has just been written, everything else is
// where the other ways have left it. The machine's peaks beside them.
#include <cstdio>
#include <functional>

#include "runtime/multigrid/galerkin_plan.hpp"
#include "runtime/multigrid/level_transitions.hpp"
#include "tests/bench/galerkin_methods.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/machine_peaks.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {
namespace {

constexpr double to_us = 1e6;

/// All levels below the finest of one body, by one way.
struct Way {
  std::string name;
  std::function<void()> renew;  ///< writes the finest matrix, or what stands for it
  std::function<void()> update;
  std::size_t bytes;
  std::vector<double> seconds{};
};

/// Runs the ways in turn, so that what else happens on the machine happens to all of them.
void measure(std::vector<Way>& ways, double least_total_s) {
  const double start = thread_seconds();
  for (int round = 0; round < 7 || (thread_seconds() - start < least_total_s && round < 400); ++round)
    for (Way& way : ways) {
      way.renew();
      const double begin = thread_seconds();
      way.update();
      way.seconds.push_back(thread_seconds() - begin);
    }
}

/// Least of the runs, thread time: what the machine can do when nobody disturbs it.
double least_us(const Way& way) { return to_us * std::ranges::min(way.seconds); }

using MakeMethod = std::unique_ptr<GalerkinMethod> (*)(const BlockPattern&, const Prolongation&,
                                                       const BlockPattern&);

/// A body with its plans, and every other way beside them.
class Comparison {
 public:
  explicit Comparison(const BodyChoice& choice)
      : name_(choice.name), body_(make_galerkin_body(choice)), source_(body_.fine.values) {
    const BlockPattern* pattern = &body_.model->pattern();
    for (const Prolongation& p : body_.prolongations) {
      plans_.push_back(std::make_unique<GalerkinPlan>(GalerkinPlan::create(*pattern, p)));
      patterns_.push_back(pattern);
      pattern = &plans_.back()->coarse_pattern();
      matrices_.emplace_back(*pattern);
      others_.emplace_back(*pattern);
    }
    add_plan();
    add_method("terms", multiplied_out);
    add_method("rows", by_rows);
    add_method("fused", fused_list);
    add_method("two_plans", two_plans);
    add_method("gustavson", gustavson);
    if (body_.kind == LevelKind::unmoved) add_elements();
    add_eigen<double>("eigen_double");
    add_eigen<float>("eigen_float");
  }

  void run(double least_total_s) {
    measure(ways_, least_total_s);
    ResultHash hash;
    for (const BlockMatrixF& matrix : matrices_) hash.add(matrix.values);
    for (const Way& way : ways_) {
      std::vector<double> seconds = way.seconds;
      print_row(row(way.name), "us", seconds, hash, to_us);
      print_row(row(way.name + ".least"), "us", least_us(way), hash);
      if (way.bytes > 0) print_row(row(way.name + ".bytes"), "kB", double(way.bytes) / 1e3, hash);
    }
    print_ratios(hash);
    print_costs(hash);
  }

 private:
  std::string row(const std::string& figure) const { return "galerkin." + name_ + "." + figure; }
  const BlockMatrixF& fine(std::size_t level) const {
    return level == 0 ? body_.fine : matrices_[level - 1];
  }

  void add_plan() {
    std::size_t bytes = 0;
    for (const auto& plan : plans_) bytes += plan->bytes();
    ways_.push_back({"plan", renew_,
                     [this] {
                       for (std::size_t l = 0; l < plans_.size(); ++l)
                         plans_[l]->replay(fine(l), matrices_[l]);
                     },
                     bytes});
  }

  void add_method(const char* name, MakeMethod make) {
    auto methods = std::make_shared<std::vector<std::unique_ptr<GalerkinMethod>>>();
    std::size_t bytes = 0;
    for (std::size_t l = 0; l < plans_.size(); ++l) {
      methods->push_back(make(*patterns_[l], body_.prolongations[l], plans_[l]->coarse_pattern()));
      bytes += methods->back()->bytes();
    }
    ways_.push_back({name, renew_,
                     [this, methods] {
                       for (std::size_t l = 0; l < methods->size(); ++l)
                         (*methods)[l]->compute(l == 0 ? body_.fine : others_[l - 1], others_[l]);
                     },
                     bytes});
    check(ways_.back(), 1e-5);
  }

  /// The first coarse level from the elements, the others by their plans.
  void add_elements() {
    const auto elements = std::make_shared<ElementProducts>(body_, plans_[0]->coarse_pattern());
    const auto rotations = std::make_shared<std::vector<ElementProducts::Rotation>>();
    for (const Mat3& r : body_.rotations) {
      auto& rotation = rotations->emplace_back();
      for (std::size_t k = 0; k < 9; ++k)
        rotation[k] = float(r(Eigen::Index(k / 3), Eigen::Index(k % 3)));
    }
    const std::vector<ElementProducts::Rotation> turned = *rotations;
    ways_.push_back({"elements", [rotations, turned] { std::ranges::copy(turned, rotations->begin()); },
                     [this, elements, rotations] {
                       elements->compute(*rotations, others_[0]);
                       for (std::size_t l = 1; l < plans_.size(); ++l)
                         plans_[l]->replay(others_[l - 1], others_[l]);
                     },
                     elements->bytes()});
    check(ways_.back(), 1e-5);
  }

  template <class Scalar>
  void add_eigen(const char* name) {
    struct Matrices {
      EigenMatrix<Scalar> fine;
      std::vector<EigenMatrix<Scalar>> p, transposed, coarse;
    };
    const auto m = std::make_shared<Matrices>();
    m->fine = eigen_matrix<Scalar>(body_.fine);
    for (const Prolongation& p : body_.prolongations) {
      m->p.push_back(eigen_matrix<Scalar>(p));
      m->transposed.push_back(m->p.back().transpose());
    }
    m->coarse.resize(m->p.size());
    const std::vector<Scalar> values(m->fine.valuePtr(), m->fine.valuePtr() + m->fine.nonZeros());
    ways_.push_back({name, [m, values] { std::ranges::copy(values, m->fine.valuePtr()); },
                     [m] {
                       for (std::size_t l = 0; l < m->p.size(); ++l) {
                         const EigenMatrix<Scalar> half =
                             (l == 0 ? m->fine : m->coarse[l - 1]) * m->p[l];
                         m->coarse[l] = m->transposed[l] * half;
                       }
                     },
                     0});
  }

  /// Ends the program if a way gives another matrix.
  void check(const Way& way, double tolerance) {
    ways_.front().update();
    way.update();
    for (std::size_t l = 0; l < plans_.size(); ++l)
      if (const double difference = relative_difference(matrices_[l], others_[l]);
          !(difference <= tolerance)) {
        std::fprintf(stderr, "%s %s: level %zu differs by %g\n", name_.c_str(), way.name.c_str(), l,
                     difference);
        std::exit(1);
      }
  }

  void print_ratios(const ResultHash& hash) const {
    const double plan = least_us(ways_.front());
    for (const Way& way : ways_)
      if (way.name != "plan")
        print_row(row("plan_faster_than_" + way.name), "x", least_us(way) / plan, hash);
  }

  /// What a replay moves at least once (upper half of A, plan, coarse matrix) and computes, per second.
  void print_costs(const ResultHash& hash) {
    double bytes = 0, flops = 0;
    for (std::size_t l = 0; l < plans_.size(); ++l) {
      bytes += double(plans_[l]->bytes()) +
               sizeof(float) * (double(fine(l).values.size()) / 2 + double(matrices_[l].values.size()));
      flops += plans_[l]->flops();
    }
    const double seconds = least_us(ways_.front()) / to_us;
    print_row(row("plan.rate"), "GB/s", bytes / seconds / 1e9, hash);
    print_row(row("plan.flops"), "GF/s", flops / seconds / 1e9, hash);
    const double made = least_seconds(3, [&] {
      for (std::size_t l = 0; l < plans_.size(); ++l)
        (void)GalerkinPlan::create(*patterns_[l], body_.prolongations[l]);
    });
    print_row(row("plan.make"), "ms", 1e3 * made, hash);
    const std::vector<LevelTransition> stored = value_or_exit(store_transitions(body_.levels));
    const double opened = least_seconds(3, [&] {
      for (std::size_t l = 0; l < plans_.size(); ++l)
        (void)value_or_exit(GalerkinPlan::open(*patterns_[l], stored[plans_.size() - 1 - l], {}));
    });
    print_row(row("plan.open"), "ms", 1e3 * opened, hash);
    std::size_t blocks = 0;
    for (const BlockMatrixF& matrix : matrices_) blocks += matrix.pattern->block_count();
    const double operator_complexity = double(blocks) / double(body_.model->pattern().block_count());
    print_row(row("coarse_over_fine_blocks"), "1", operator_complexity, hash);
    print_row(row("tets"), "1", double(body_.model->tet_count()), hash);
  }

  std::string name_;
  GalerkinBody body_;
  std::vector<std::unique_ptr<GalerkinPlan>> plans_;
  std::vector<const BlockPattern*> patterns_;  ///< of the finer level of every plan
  std::vector<BlockMatrixF> matrices_, others_;
  std::vector<float> source_;
  std::function<void()> renew_ = [this] { std::ranges::copy(source_, body_.fine.values.begin()); };
  std::vector<Way> ways_;
};

void print_peaks() {
  const ResultHash none;
  print_row("galerkin.peak.fma", "GF/s", fma_flops_per_s() / 1e9, none);
  print_row("galerkin.peak.triad_l2", "GB/s", triad_bytes_per_s(std::size_t{512} << 10) / 1e9, none);
  print_row("galerkin.peak.triad_l3", "GB/s", triad_bytes_per_s(std::size_t{12} << 20) / 1e9, none);
  print_row("galerkin.peak.triad_memory", "GB/s", triad_bytes_per_s(std::size_t{256} << 20) / 1e9,
            none);
}

}  // namespace
}  // namespace souple::bench

/// Without arguments all bodies; with names, those.
int main(int argument_count, char** arguments) {
  using namespace souple::bench;
  print_peaks();
  for (const BodyChoice& choice : galerkin_bodies()) {
    bool wanted = argument_count == 1;
    for (int k = 1; k < argument_count; ++k) wanted |= choice.name == arguments[k];
    if (wanted) Comparison(choice).run(0.5);
  }
  return 0;
}
