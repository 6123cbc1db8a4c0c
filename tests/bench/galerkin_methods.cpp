// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/galerkin_methods.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/multigrid/block_kernel.hpp"
#include "runtime/multigrid/fused_terms.hpp"

namespace souple::bench {
namespace {

using block_kernel::Block;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
float* place(float* values, Index block) { return values + block_kernel::floats * at(block); }
const float* place(const float* values, Index block) {
  return values + block_kernel::floats * at(block);
}
void add_to(float* sum, float weight, const float* b) {
  block_kernel::store(sum, block_kernel::add(block_kernel::load(sum), weight, block_kernel::load(b)));
}

struct Term {
  Index source;
  float weight;
};

/// Lists one after another: those of item k end at end[k].
struct Lists {
  std::vector<Index> end;
  std::vector<Term> terms;

  explicit Lists(const std::vector<std::vector<Term>>& lists) {
    for (const auto& list : lists) {
      terms.insert(terms.end(), list.begin(), list.end());
      end.push_back(Index(terms.size()));
    }
  }
  /// Every item of `sums` as its list says.
  void replay(const float* source, float* sums) const {
    std::size_t term = 0;
    for (std::size_t k = 0; k < end.size(); ++k) {
      Block sum = block_kernel::zero();
      for (; term < at(end[k]); ++term)
        sum = block_kernel::add(sum, terms[term].weight,
                                block_kernel::load(place(source, terms[term].source)));
      block_kernel::store(sums + block_kernel::floats * k, sum);
    }
  }
  std::size_t bytes() const { return end.size() * sizeof(Index) + terms.size() * sizeof(Term); }
};

/// FusedTerms or RowProducts.
template <class Products>
class Shipped final : public GalerkinMethod {
 public:
  explicit Shipped(Products products) : products_(std::move(products)) {}
  void compute(const BlockMatrixF& fine, BlockMatrixF& coarse) override {
    products_.replay(fine, coarse);
  }
  std::size_t bytes() const override { return products_.bytes(); }

 private:
  Products products_;
};

class FusedList final : public GalerkinMethod {
 public:
  FusedList(const BlockPattern& fine, const Prolongation& p, const BlockPattern& coarse)
      : lists_(make_lists(fine, p, coarse)), sums_(block_kernel::floats * lists_.end.size()) {
    for (Index a = 0; a < coarse.node_count(); ++a)
      for (Index k = coarse.diagonal[at(a)]; k < coarse.row_begin[at(a) + 1]; ++k)
        targets_.push_back({k, coarse.find(coarse.column[at(k)], a)});
  }
  void compute(const BlockMatrixF& fine, BlockMatrixF& coarse) override {
    lists_.replay(fine.values.data(), sums_.data());
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      const float* const sum = sums_.data() + block_kernel::floats * k;
      float* const upper = place(coarse.values.data(), targets_[k][0]);
      float* const lower = place(coarse.values.data(), targets_[k][1]);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) upper[3 * i + j] = lower[3 * j + i] = sum[3 * i + j];
    }
  }
  std::size_t bytes() const override { return lists_.bytes() + 8 * targets_.size(); }

 private:
  static Lists make_lists(const BlockPattern& fine, const Prolongation& p, const BlockPattern& coarse) {
    std::vector<std::vector<Term>> lists(coarse.block_count());
    for (Index i = 0; i < fine.node_count(); ++i)
      for (Index k = fine.row_begin[at(i)]; k < fine.row_begin[at(i) + 1]; ++k)
        for (Index m = p.row_begin[at(i)]; m < p.row_begin[at(i) + 1]; ++m) {
          const Index j = fine.column[at(k)];
          for (Index n = p.row_begin[at(j)]; n < p.row_begin[at(j) + 1]; ++n)
            if (p.column[at(m)] <= p.column[at(n)])
              lists[at(coarse.find(p.column[at(m)], p.column[at(n)]))].push_back(
                  {k, float(p.weight[at(m)] * p.weight[at(n)])});
        }
    std::vector<std::vector<Term>> upper;
    for (Index a = 0; a < coarse.node_count(); ++a)
      for (Index k = coarse.diagonal[at(a)]; k < coarse.row_begin[at(a) + 1]; ++k)
        upper.push_back(std::move(lists[at(k)]));
    return Lists(upper);
  }

  Lists lists_;
  std::vector<float> sums_;
  std::vector<std::array<Index, 2>> targets_;
};

/// Rows of A P: coarse nodes, ascending.
struct HalfPattern {
  std::vector<Index> row_begin{0}, column;

  HalfPattern(const BlockPattern& fine, const Prolongation& p) {
    for (Index i = 0; i < fine.node_count(); ++i) {
      const std::size_t first = column.size();
      for (Index k = fine.row_begin[at(i)]; k < fine.row_begin[at(i) + 1]; ++k) {
        const std::size_t j = at(fine.column[at(k)]);
        column.insert(column.end(), p.column.begin() + p.row_begin[j],
                      p.column.begin() + p.row_begin[j + 1]);
      }
      const auto begin = column.begin() + std::ptrdiff_t(first);
      std::sort(begin, column.end());
      column.erase(std::unique(begin, column.end()), column.end());
      row_begin.push_back(Index(column.size()));
    }
  }
  Index find(Index row, Index col) const {
    const auto first = column.begin() + row_begin[at(row)],
               last = column.begin() + row_begin[at(row) + 1];
    return Index(std::lower_bound(first, last, col) - column.begin());
  }
};

class TwoPlans final : public GalerkinMethod {
 public:
  TwoPlans(const BlockPattern& fine, const Prolongation& p, const BlockPattern& coarse)
      : TwoPlans(fine, p, coarse, HalfPattern(fine, p)) {}
  void compute(const BlockMatrixF& fine, BlockMatrixF& coarse) override {
    first_.replay(fine.values.data(), half_.data());
    second_.replay(half_.data(), coarse.values.data());
  }
  std::size_t bytes() const override {
    return first_.bytes() + second_.bytes() + half_.size() * sizeof(float);
  }

 private:
  TwoPlans(const BlockPattern& fine, const Prolongation& p, const BlockPattern& coarse,
           const HalfPattern& half)
      : first_(first_lists(fine, p, half)),
        second_(second_lists(p, coarse, half)),
        half_(block_kernel::floats * half.column.size()) {}

  static std::vector<std::vector<Term>> first_lists(const BlockPattern& fine, const Prolongation& p,
                                                    const HalfPattern& half) {
    std::vector<std::vector<Term>> lists(half.column.size());
    for (Index i = 0; i < fine.node_count(); ++i)
      for (Index k = fine.row_begin[at(i)]; k < fine.row_begin[at(i) + 1]; ++k) {
        const Index j = fine.column[at(k)];
        for (Index n = p.row_begin[at(j)]; n < p.row_begin[at(j) + 1]; ++n)
          lists[at(half.find(i, p.column[at(n)]))].push_back({k, float(p.weight[at(n)])});
      }
    return lists;
  }
  static std::vector<std::vector<Term>> second_lists(const Prolongation& p, const BlockPattern& coarse,
                                                     const HalfPattern& half) {
    std::vector<std::vector<Term>> lists(coarse.block_count());
    for (Index i = 0; i < p.fine_count(); ++i)
      for (Index m = p.row_begin[at(i)]; m < p.row_begin[at(i) + 1]; ++m)
        for (Index k = half.row_begin[at(i)]; k < half.row_begin[at(i) + 1]; ++k)
          lists[at(coarse.find(p.column[at(m)], half.column[at(k)]))].push_back(
              {k, float(p.weight[at(m)])});
    return lists;
  }

  Lists first_, second_;
  std::vector<float> half_;  ///< values of A P
};

class Gustavson final : public GalerkinMethod {
 public:
  Gustavson(const BlockPattern& fine, const Prolongation& p, const BlockPattern& coarse)
      : half_(fine, p),
        p_(p),
        values_(block_kernel::floats * half_.column.size()),
        place_(at(coarse.node_count())),
        weight_(p.weight.begin(), p.weight.end()),
        hanging_(at(coarse.node_count())) {
    for (Index i = 0; i < p.fine_count(); ++i)
      for (Index m = p.row_begin[at(i)]; m < p.row_begin[at(i) + 1]; ++m)
        hanging_[at(p.column[at(m)])].push_back({i, weight_[at(m)]});
  }
  void compute(const BlockMatrixF& fine, BlockMatrixF& coarse) override {
    multiply_right(fine);
    multiply_left(coarse);
  }
  std::size_t bytes() const override {
    return (half_.row_begin.size() + half_.column.size()) * sizeof(Index) +
           values_.size() * sizeof(float) + weight_.size() * (sizeof(float) + sizeof(Term));
  }

 private:
  void multiply_right(const BlockMatrixF& fine) {
    std::ranges::fill(values_, 0.0F);
    const BlockPattern& pattern = *fine.pattern;
    for (std::size_t i = 0; i + 1 < half_.row_begin.size(); ++i) {
      for (Index k = half_.row_begin[i]; k < half_.row_begin[i + 1]; ++k)
        place_[at(half_.column[at(k)])] = k;
      for (Index k = pattern.row_begin[i]; k < pattern.row_begin[i + 1]; ++k) {
        const std::size_t j = at(pattern.column[at(k)]);
        for (Index n = p_.row_begin[j]; n < p_.row_begin[j + 1]; ++n)
          add_to(place(values_.data(), place_[at(p_.column[at(n)])]), weight_[at(n)],
                 place(fine.values.data(), k));
      }
    }
  }
  void multiply_left(BlockMatrixF& coarse) {
    std::ranges::fill(coarse.values, 0.0F);
    const BlockPattern& pattern = *coarse.pattern;
    for (std::size_t a = 0; a < hanging_.size(); ++a) {
      for (Index k = pattern.row_begin[a]; k < pattern.row_begin[a + 1]; ++k)
        place_[at(pattern.column[at(k)])] = k;
      for (const Term& term : hanging_[a])
        for (Index k = half_.row_begin[at(term.source)]; k < half_.row_begin[at(term.source) + 1]; ++k)
          add_to(place(coarse.values.data(), place_[at(half_.column[at(k)])]), term.weight,
                 place(values_.data(), k));
    }
  }

  HalfPattern half_;
  const Prolongation& p_;
  std::vector<float> values_;  ///< of A P
  std::vector<Index> place_;   ///< of every coarse node in the row at hand
  std::vector<float> weight_;
  std::vector<std::vector<Term>> hanging_;  ///< by coarse node: fine nodes and their weights
};

}  // namespace

std::unique_ptr<GalerkinMethod> multiplied_out(const BlockPattern& fine, const Prolongation& p,
                                               const BlockPattern&) {
  return std::make_unique<Shipped<FusedTerms>>(FusedTerms::create(fine, plan_row_products(fine, p)));
}
std::unique_ptr<GalerkinMethod> by_rows(const BlockPattern& fine, const Prolongation& p,
                                        const BlockPattern&) {
  return std::make_unique<Shipped<RowProducts>>(plan_row_products(fine, p).products);
}
std::unique_ptr<GalerkinMethod> fused_list(const BlockPattern& fine, const Prolongation& p,
                                           const BlockPattern& coarse) {
  return std::make_unique<FusedList>(fine, p, coarse);
}
std::unique_ptr<GalerkinMethod> two_plans(const BlockPattern& fine, const Prolongation& p,
                                          const BlockPattern& coarse) {
  return std::make_unique<TwoPlans>(fine, p, coarse);
}
std::unique_ptr<GalerkinMethod> gustavson(const BlockPattern& fine, const Prolongation& p,
                                          const BlockPattern& coarse) {
  return std::make_unique<Gustavson>(fine, p, coarse);
}

ElementProducts::ElementProducts(const GalerkinBody& body, const BlockPattern& coarse)
    : mass_(coarse.block_count(), 0) {
  const MeshLevel& level = body.levels.end()[-2];
  for (const Tet& tet : level.mesh.tets) {
    const auto node = [&](std::size_t k) { return as_vec3(level.mesh.nodes[at(tet[k])]); };
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = node(std::size_t(k) + 1) - node(0);
    const Mat3 inverse = edges.inverse();
    CoarseTet coarse_tet;
    coarse_tet.child_volume = float(edges.determinant() / 48);
    for (int axis = 0; axis < 3; ++axis) {
      coarse_tet.gradients[0][std::size_t(axis)] = float(-inverse.col(axis).sum());
      for (int k = 0; k < 3; ++k)
        coarse_tet.gradients[std::size_t(k) + 1][std::size_t(axis)] = float(inverse(k, axis));
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) coarse_tet.block[4 * i + j] = coarse.find(tet[i], tet[j]);
    tets_.push_back(coarse_tet);
  }
  const Prolongation& p = body.prolongations.front();
  for (Index i = 0; i < p.fine_count(); ++i)
    for (Index m = p.row_begin[at(i)]; m < p.row_begin[at(i) + 1]; ++m)
      for (Index n = p.row_begin[at(i)]; n < p.row_begin[at(i) + 1]; ++n)
        mass_[at(coarse.find(p.column[at(m)], p.column[at(n)]))] +=
            float(mass_factor * body.model->masses()[at(i)] * p.weight[at(m)] * p.weight[at(n)]);
}

namespace {

constexpr std::size_t lanes = 8;
using Lanes = std::array<float, lanes>;

/// sum[i][j] += g_i g_j^T for i <= j, in every lane.
void add_outer_products(const std::array<std::array<Lanes, 3>, 4>& g,
                        std::array<std::array<Lanes, 9>, 10>& sum) {
  for (std::size_t i = 0, pair = 0; i < 4; ++i)
    for (std::size_t j = i; j < 4; ++j, ++pair)
      for (std::size_t xy = 0; xy < 9; ++xy)
        for (std::size_t l = 0; l < lanes; ++l) sum[pair][xy][l] += g[i][xy / 3][l] * g[j][xy % 3][l];
}

/// The stiffness of isotropic material, lambda G + mu G^T + mu tr(G), of one lane of an outer product.
void scatter(const std::array<Lanes, 9>& outer, std::size_t lane, float lambda, float mu, float* upper,
             float* lower) {
  const float trace = mu * (outer[0][lane] + outer[4][lane] + outer[8][lane]);
  for (std::size_t x = 0; x < 3; ++x)
    for (std::size_t y = 0; y < 3; ++y) {
      const float entry =
          lambda * outer[3 * x + y][lane] + mu * outer[3 * y + x][lane] + (x == y ? trace : 0);
      upper[3 * x + y] += entry;
      if (upper != lower) lower[3 * y + x] += entry;
    }
}

}  // namespace

void ElementProducts::compute(std::span<const Rotation> rotations, BlockMatrixF& coarse) const {
  const Lame lame = lame_parameters(1e4, 0.4);
  for (std::size_t k = 0; k < mass_.size(); ++k)
    coarse.block(Index(k)) = mass_[k] * Eigen::Matrix3f::Identity();
  alignas(32) std::array<std::array<Lanes, 9>, 10> sum;
  alignas(32) std::array<std::array<Lanes, 3>, 4> g;
  for (std::size_t first = 0; first < tets_.size(); first += lanes) {
    const std::size_t count = std::min(lanes, tets_.size() - first);
    sum = {};
    g = {};
    for (std::size_t child = 0; child < 8; ++child) {
      for (std::size_t l = 0; l < count; ++l) {
        const Rotation& r = rotations[8 * (first + l) + child];
        for (std::size_t i = 0; i < 4; ++i) {
          const auto& gradient = tets_[first + l].gradients[i];
          for (std::size_t x = 0; x < 3; ++x)
            g[i][x][l] =
                r[3 * x] * gradient[0] + r[3 * x + 1] * gradient[1] + r[3 * x + 2] * gradient[2];
        }
      }
      add_outer_products(g, sum);
    }
    for (std::size_t l = 0; l < count; ++l) {
      const CoarseTet& tet = tets_[first + l];
      const float lambda = float(stiffness_factor * lame.lambda) * tet.child_volume;
      const float mu = float(stiffness_factor * lame.mu) * tet.child_volume;
      for (std::size_t i = 0, pair = 0; i < 4; ++i)
        for (std::size_t j = i; j < 4; ++j, ++pair)
          scatter(sum[pair], l, lambda, mu, place(coarse.values.data(), tet.block[4 * i + j]),
                  place(coarse.values.data(), tet.block[4 * j + i]));
    }
  }
}

std::size_t ElementProducts::bytes() const {
  return tets_.size() * sizeof(CoarseTet) + mass_.size() * sizeof(float);
}

template <class Scalar>
EigenMatrix<Scalar> eigen_matrix(const BlockMatrixF& a) {
  const Index n = 3 * a.pattern->node_count();
  std::vector<Eigen::Triplet<Scalar>> entries;
  for (Index i = 0; i < a.pattern->node_count(); ++i)
    for (Index k = a.pattern->row_begin[at(i)]; k < a.pattern->row_begin[at(i) + 1]; ++k)
      for (Index x = 0; x < 3; ++x)
        for (Index y = 0; y < 3; ++y)
          entries.emplace_back(3 * i + x, 3 * a.pattern->column[at(k)] + y, Scalar(a.block(k)(x, y)));
  EigenMatrix<Scalar> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

template <class Scalar>
EigenMatrix<Scalar> eigen_matrix(const Prolongation& p) {
  std::vector<Eigen::Triplet<Scalar>> entries;
  for (Index i = 0; i < p.fine_count(); ++i)
    for (Index k = p.row_begin[at(i)]; k < p.row_begin[at(i) + 1]; ++k)
      for (Index x = 0; x < 3; ++x)
        entries.emplace_back(3 * i + x, 3 * p.column[at(k)] + x, Scalar(p.weight[at(k)]));
  EigenMatrix<Scalar> matrix(3 * p.fine_count(), 3 * p.coarse_count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

template EigenMatrix<float> eigen_matrix(const BlockMatrixF&);
template EigenMatrix<double> eigen_matrix(const BlockMatrixF&);
template EigenMatrix<float> eigen_matrix(const Prolongation&);
template EigenMatrix<double> eigen_matrix(const Prolongation&);

double relative_difference(const BlockMatrixF& a, const BlockMatrixF& b) {
  double most = 0, largest = 0;
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    most = std::max(most, std::abs(double(a.values[k]) - double(b.values[k])));
    largest = std::max(largest, std::abs(double(a.values[k])));
  }
  return most / largest;
}

}  // namespace souple::bench
