// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/peeling.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tools/compliance/block_sampler.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {
namespace {

constexpr Eigen::Index task_columns = peeling_columns;
// Columns of a round of sampling: some tasks, so that two threads share it.
constexpr Eigen::Index round_columns = 2 * task_columns;
// The first round of a level expects this share of the rank of the level above it.
constexpr double expected_rank_share = 0.6;
// Ranks of surfaces cut in two, over the root of the number of nodes: for the progress only.
constexpr double first_rank_guess = 8;

// From so many blocks on, a level's dense work is shared out by blocks.
constexpr std::size_t side_by_side = 8;

Eigen::Index tasks_for(Eigen::Index columns) { return (columns + task_columns - 1) / task_columns; }

class Peeling {
 public:
  Peeling(const PeelingProblem& problem, const PeelingOptions& options)
      : problem_(problem),
        options_(options),
        size_(3 * Eigen::Index(problem.node_count)),
        pool_(options.threads),
        omega_(pool_.threads()),
        product_(pool_.threads()) {}

  Result<PeeledMatrix> run() {
    result_.blocks.resize((std::size_t{1} << problem_.depth) - 1);
    for (int level = 0; level < problem_.depth; ++level) {
      level_columns_ = 0;
      if (auto status = peel_level(level); !status) return status.issue();
    }
    level_columns_ = 0;
    if (!peel_leaves()) return interruption();
    result_.planned_bytes = std::max(largest_bytes_, bytes_);
    return std::move(result_);
  }

 private:
  Issue interruption() const { return make_issue(IssueCode::interrupted, "the sampling was stopped"); }

  ClusterRange cluster(int level, Index i) const {
    return cluster_range(problem_.node_count, level, i);
  }

  /// One task: fills random or basis vectors by `fill`, multiplies, subtracts the levels above, and
  /// hands the product to `use`.
  template <class Fill, class Use>
  bool multiply(int level, Eigen::Index columns, ActiveChildren active, Fill fill, Use use) {
    std::atomic<bool> ok{true};
    pool_.run(std::size_t(tasks_for(columns)), [&](std::size_t task, unsigned worker) {
      if (!ok) return;
      const Eigen::Index begin = Eigen::Index(task) * task_columns;
      const Eigen::Index count = std::min(task_columns, columns - begin);
      Eigen::MatrixXf &omega = omega_[worker], &product = product_[worker];
      omega.setZero(size_, count);
      fill(begin, omega);
      product = omega;
      if (!problem_.apply(product, worker)) {
        ok = false;
        return;
      }
      add_levels(result_, problem_.node_count, level, -1, omega, product, active);
      use(begin, product);
      const std::int64_t done = level_columns_ += count;
      if (worker == 0) report(level, done);
    });
    result_.products += columns;
    return ok;
  }

  Status peel_level(int level) {
    const Index pairs = Index{1} << level;
    std::vector<BlockSampler> samplers;
    for (Index i = 0; i < pairs; ++i)
      samplers.emplace_back(3 * cluster(level + 1, 2 * i).size(),
                            3 * cluster(level + 1, 2 * i + 1).size(), block_bounds(level));
    if (auto status = sample(level, samplers); !status) return status;
    Eigen::Index rank = 0;
    for (const BlockSampler& sampler : samplers) rank = std::max(rank, sampler.rank());
    result_.sampled_rank.push_back(Index(rank));
    std::atomic<bool> sound{true};
    for_blocks(samplers.size(), [&](std::size_t i, const PieceRunner& run) {
      if (!samplers[i].join_basis(run)) sound = false;
    });
    if (sound && !multiply_bases(level, rank, samplers)) return interruption();
    for_blocks(samplers.size(), [&](std::size_t i, const PieceRunner& run) {
      LowRankBlock& block = result_.blocks[std::size_t(block_of_cluster(level, Index(i)))];
      if (!sound || !samplers[i].finish(block, run)) sound = false;
      samplers[i] = BlockSampler();
    });
    if (!sound)
      return make_issue(IssueCode::compliance_tolerance_missed,
                        "singular values of level " + std::to_string(level) + " were not found");
    for (Index i = 0; i < pairs; ++i) {
      const LowRankBlock& block = result_.blocks[std::size_t(block_of_cluster(level, i))];
      bytes_ += std::size_t(block.left.size() + block.right.size()) * sizeof(float);
    }
    return {};
  }

  // A level holds bases and images, and for a while the singular vectors made of them.
  Status check_memory(int level, const std::vector<BlockSampler>& samplers, Eigen::Index width) {
    std::size_t needed = bytes_;
    for (const BlockSampler& sampler : samplers) needed += 2 * sampler.bytes_with(width);
    largest_bytes_ = std::max(largest_bytes_, needed);
    if (needed <= options_.memory_limit_bytes) return {};
    return make_issue(IssueCode::compliance_out_of_memory,
                      "the low-rank blocks down to level " + std::to_string(level) +
                          " need more than " + std::to_string(needed / 1000000) + " MB, " +
                          std::to_string(options_.memory_limit_bytes / 1000000) +
                          " MB are left for them");
  }

  // Few blocks are worked on one after another by all threads, many side by side.
  template <class Work>
  void for_blocks(std::size_t count, Work work) {
    if (count < side_by_side) {
      const PieceRunner on_all_threads = [&](std::size_t pieces,
                                             const std::function<void(std::size_t)>& piece) {
        pool_.run(pieces, [&](std::size_t k, unsigned) { piece(k); });
      };
      for (std::size_t i = 0; i < count; ++i) work(i, on_all_threads);
      return;
    }
    const PieceRunner one_after_another = [](std::size_t pieces,
                                             const std::function<void(std::size_t)>& piece) {
      for (std::size_t k = 0; k < pieces; ++k) piece(k);
    };
    pool_.run(count, [&](std::size_t i, unsigned) { work(i, one_after_another); });
  }

  // A Frobenius bound is shared out evenly over the levels, and within a level over its blocks; every
  // block stands twice in the symmetric matrix.
  BlockBounds block_bounds(int level) const {
    const double share =
        options_.frobenius ? std::sqrt(0.5 / double(problem_.depth) / std::ldexp(1.0, level)) : 1;
    return {options_.frobenius, share * options_.sampled_bound, share * options_.truncated_bound,
            options_.noise};
  }

  double expected_rank(int level) const {
    return level == 0 ? 0 : expected_rank_share * double(result_.sampled_rank[std::size_t(level) - 1]);
  }

  // Ranks go about as the root of the number of nodes, and so does the work of the levels.
  void report(int level, std::int64_t columns) {
    if (!options_.progress) return;
    const double ratio = std::sqrt(0.5), whole = 1 - std::pow(ratio, problem_.depth + 1);
    const double before = 1 - std::pow(ratio, level), share = (1 - ratio) * std::pow(ratio, level);
    const double first_guess = first_rank_guess * std::sqrt(double(problem_.node_count));
    const double expected = 2 * std::max({expected_rank(level), level == 0 ? first_guess : 0.0, 100.0});
    options_.progress((before + share * std::min(1.0, double(columns) / expected)) / whole);
  }

  Status sample(int level, std::vector<BlockSampler>& samplers) {
    const double expected = expected_rank(level);
    Eigen::Index width = std::max(round_columns, task_columns * Eigen::Index(expected / task_columns));
    std::uint64_t drawn = 0;
    const auto open = [](const BlockSampler& sampler) { return !sampler.complete(); };
    while (std::ranges::any_of(samplers, open)) {
      if (auto status = check_memory(level, samplers, width); !status) return status;
      for (BlockSampler& sampler : samplers)
        if (open(sampler)) sampler.begin_round(width);
      const auto fill = [&](Eigen::Index begin, Eigen::MatrixXf& omega) {
        for (Index i = 0; i < Index(samplers.size()); ++i) {
          const ClusterRange right = cluster(level + 1, 2 * i + 1);
          fill_signs(std::uint64_t(level), drawn + std::uint64_t(begin), 3 * right.begin,
                     omega.middleRows(3 * right.begin, 3 * right.size()));
        }
      };
      const auto use = [&](Eigen::Index begin, const Eigen::MatrixXf& product) {
        for (Index i = 0; i < Index(samplers.size()); ++i) {
          const ClusterRange left = cluster(level + 1, 2 * i);
          if (open(samplers[std::size_t(i)]))
            samplers[std::size_t(i)].take(begin, product.middleRows(3 * left.begin, 3 * left.size()));
        }
      };
      if (!multiply(level, width, {1, 0}, fill, use)) return interruption();
      pool_.run(samplers.size(), [&](std::size_t i, unsigned) {
        if (open(samplers[i])) samplers[i].end_round();
      });
      drawn += std::uint64_t(width);
      width = round_columns;
    }
    return {};
  }

  bool multiply_bases(int level, Eigen::Index rank, std::vector<BlockSampler>& samplers) {
    const auto columns_of = [&](const BlockSampler& sampler, Eigen::Index begin) {
      return std::clamp<Eigen::Index>(sampler.rank() - begin, 0, task_columns);
    };
    const auto fill = [&](Eigen::Index begin, Eigen::MatrixXf& omega) {
      for (Index i = 0; i < Index(samplers.size()); ++i) {
        const BlockSampler& sampler = samplers[std::size_t(i)];
        const ClusterRange left = cluster(level + 1, 2 * i);
        const Eigen::Index count = columns_of(sampler, begin);
        if (count > 0)
          omega.block(3 * left.begin, 0, 3 * left.size(), count) =
              sampler.basis().middleCols(begin, count);
      }
    };
    const auto use = [&](Eigen::Index begin, const Eigen::MatrixXf& product) {
      for (Index i = 0; i < Index(samplers.size()); ++i) {
        BlockSampler& sampler = samplers[std::size_t(i)];
        const ClusterRange right = cluster(level + 1, 2 * i + 1);
        const Eigen::Index count = columns_of(sampler, begin);
        if (count > 0)
          sampler.image().middleCols(begin, count) =
              product.block(3 * right.begin, 0, 3 * right.size(), count);
      }
    };
    return multiply(level, rank, {0, 1}, fill, use);
  }

  // A sign for every leaf, so that what the levels above missed does not add up in one direction.
  bool peel_leaves() {
    const Index count = Index{1} << problem_.depth;
    result_.leaves.resize(std::size_t(count));
    Eigen::MatrixXf sign(count, 1);
    fill_signs(std::uint64_t(problem_.depth), 0, 0, sign);
    Eigen::Index columns = 0;
    for (Index l = 0; l < count; ++l) {
      const Eigen::Index size = 3 * cluster(problem_.depth, l).size();
      result_.leaves[std::size_t(l)].resize(size, size);
      columns = std::max(columns, size);
    }
    const auto fill = [&](Eigen::Index begin, Eigen::MatrixXf& omega) {
      for (Index l = 0; l < count; ++l) {
        const ClusterRange leaf = cluster(problem_.depth, l);
        for (Eigen::Index c = 0; c < omega.cols() && begin + c < 3 * leaf.size(); ++c)
          omega(3 * leaf.begin + begin + c, c) = sign(l, 0);
      }
    };
    const auto use = [&](Eigen::Index begin, const Eigen::MatrixXf& product) {
      for (Index l = 0; l < count; ++l) {
        const ClusterRange leaf = cluster(problem_.depth, l);
        for (Eigen::Index c = 0; c < product.cols() && begin + c < 3 * leaf.size(); ++c)
          result_.leaves[std::size_t(l)].col(begin + c) =
              sign(l, 0) * product.col(c).segment(3 * leaf.begin, 3 * leaf.size());
      }
    };
    if (!multiply(problem_.depth, columns, {}, fill, use)) return false;
    for (Eigen::MatrixXf& leaf : result_.leaves) leaf = (0.5F * (leaf + leaf.transpose())).eval();
    return true;
  }

  const PeelingProblem& problem_;
  const PeelingOptions& options_;
  Eigen::Index size_;
  WorkerPool pool_;
  std::vector<Eigen::MatrixXf> omega_, product_;  ///< by worker
  PeeledMatrix result_;
  std::size_t bytes_ = 0;  ///< of finished blocks
  std::size_t largest_bytes_ = 0;
  std::atomic<std::int64_t> level_columns_{0};
};

}  // namespace

void add_levels(const PeeledMatrix& matrix, Index node_count, int level_count, float factor,
                const ConstFloatRef& x, FloatRef y, ActiveChildren active) {
  // The rows of child `child` at level `level` + 1, those of inactive ones left out.
  const auto for_rows = [&](int level, Index child, int side, auto use) {
    const Index first = cluster_range(node_count, level + 1, child).begin;
    if (side < 0) return use(cluster_range(node_count, level + 1, child), first);
    const Index parts = Index{1} << (level_count - level);
    for (Index part = side; part < parts; part += 2)
      use(cluster_range(node_count, level_count + 1, child * parts + part), first);
  };
  Eigen::MatrixXf inner;
  const auto add = [&](int level, const LowRankBlock& block, Index to, const Eigen::MatrixXf& u,
                       Index from, const Eigen::MatrixXf& v) {
    inner.setZero(block.singular.size(), x.cols());
    for_rows(level, from, active.from, [&](ClusterRange rows, Index first) {
      add_transposed_product(1, v.middleRows(3 * (rows.begin - first), 3 * rows.size()),
                             x.middleRows(3 * rows.begin, 3 * rows.size()), inner);
    });
    inner = block.singular.asDiagonal() * inner;
    for_rows(level, to, active.to, [&](ClusterRange rows, Index first) {
      add_product(factor, u.middleRows(3 * (rows.begin - first), 3 * rows.size()), inner,
                  y.middleRows(3 * rows.begin, 3 * rows.size()));
    });
  };
  for (int level = 0; level < level_count; ++level)
    for (Index i = 0; i < Index{1} << level; ++i) {
      const LowRankBlock& block = matrix.blocks[std::size_t(block_of_cluster(level, i))];
      if (block.singular.size() == 0) continue;
      add(level, block, 2 * i, block.left, 2 * i + 1, block.right);
      add(level, block, 2 * i + 1, block.right, 2 * i, block.left);
    }
}

Result<PeeledMatrix> peel(const PeelingProblem& problem, const PeelingOptions& options) {
  use_one_blas_thread();
  return Peeling(problem, options).run();
}

}  // namespace souple
