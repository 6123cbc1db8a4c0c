// SPDX-License-Identifier: MIT
#include "runtime/fem/sparse_factor.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>

namespace souple {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Factor = Eigen::SimplicialLLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>>;

}  // namespace

struct SparseFactor::State {
  Sparse matrix;                              ///< lower triangle of the part, columns compressed
  std::vector<std::pair<Index, int>> origin;  ///< of every non-zero: block and entry of the full matrix
  Factor factor;
};

SparseFactor::SparseFactor() : state_(std::make_unique<State>()) {}
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;
SparseFactor::~SparseFactor() = default;

void SparseFactor::analyze(const BlockPattern* pattern, std::span<const Index> nodes) {
  std::vector<Index> local(pattern->node_count(), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) local[nodes[k]] = static_cast<Index>(k);
  State& s = *state_;
  // A is symmetric: the lower triangle by columns is read from the rows of its upper triangle.
  const auto size = 3 * static_cast<Eigen::Index>(nodes.size());
  s.matrix.resize(size, size);
  struct Entry {
    Index row, block;
    int entry;
  };
  std::vector<Entry> column;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      column.clear();
      const Index col = static_cast<Index>(3 * k) + c;
      for (Index b = pattern->row_begin[nodes[k]]; b < pattern->row_begin[nodes[k] + 1]; ++b)
        for (int r = 0; r < 3; ++r) {
          const Index other = local[pattern->column[b]];
          if (other >= 0 && 3 * other + r >= col) column.push_back({3 * other + r, b, 3 * c + r});
        }
      std::ranges::sort(column, {}, &Entry::row);
      s.matrix.startVec(col);
      for (const Entry& e : column) {
        s.matrix.insertBack(e.row, col) = 0;
        s.origin.emplace_back(e.block, e.entry);
      }
    }
  s.matrix.finalize();
  if (size > 0) s.factor.analyzePattern(s.matrix);
}

bool SparseFactor::factorize(const BlockMatrix& a) {
  State& s = *state_;
  if (s.matrix.rows() == 0) return true;
  for (std::size_t k = 0; k < s.origin.size(); ++k)
    s.matrix.valuePtr()[k] = a.values[9 * std::size_t(s.origin[k].first) + s.origin[k].second];
  s.factor.factorize(s.matrix);
  return s.factor.info() == Eigen::Success;
}

Eigen::Index SparseFactor::size() const { return state_->matrix.rows(); }

void SparseFactor::solve(Eigen::Ref<Eigen::VectorXd> x, Eigen::Ref<Eigen::VectorXd> work) const {
  const State& s = *state_;
  const Eigen::Index n = size();
  if (n == 0) return;
  const auto& permutation = s.factor.permutationP().indices();
  for (Eigen::Index i = 0; i < n; ++i) work[permutation[i]] = x[i];
  // The nested expression holds the factor by columns, diagonal first.
  const auto& l = s.factor.matrixL().nestedExpression();
  const int* begin = l.outerIndexPtr();
  const int* rows = l.innerIndexPtr();
  const double* values = l.valuePtr();
  for (Eigen::Index j = 0; j < n; ++j) {
    const double value = work[j] /= values[begin[j]];
    for (int k = begin[j] + 1; k < begin[j + 1]; ++k) work[rows[k]] -= values[k] * value;
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    double sum = work[j];
    for (int k = begin[j] + 1; k < begin[j + 1]; ++k) sum -= values[k] * work[rows[k]];
    work[j] = sum / values[begin[j]];
  }
  for (Eigen::Index i = 0; i < n; ++i) x[i] = work[permutation[i]];
}

std::size_t SparseFactor::bytes() const {
  if (size() == 0) return 0;
  const auto entries = std::size_t(state_->factor.matrixL().nestedExpression().nonZeros());
  return (entries + std::size_t(state_->matrix.nonZeros())) * (sizeof(double) + sizeof(int)) +
         state_->origin.size() * sizeof(state_->origin[0]);
}

}  // namespace souple
