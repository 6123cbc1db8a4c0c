// SPDX-License-Identifier: MIT
#include "runtime/fem/half_factor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "runtime/fem/half_products.hpp"
#include "runtime/fem/nested_dissection.hpp"

namespace souple {
namespace {

using Dense = Eigen::MatrixXd;

constexpr Index leaf_nodes = 8;  // below, cutting saves less than the bookkeeping costs

std::size_t padded(std::size_t scalars) { return (scalars + 15) / 16 * 16; }

// Integers round to a share of the largest of a piece: stiff nodes must not drown soft ones.
constexpr double largest_contrast = 32;

// The largest stiffness of the nodes at the places over the least.
double contrast_of(const BlockMatrix& a, std::span<const Index> order, std::span<const Index> places) {
  double least = std::numeric_limits<double>::max(), most = 0;
  for (const Index place : places) {
    const Index node = order[std::size_t(place)];
    const double stiffness = a.block(a.pattern->diagonal[std::size_t(node)]).trace();
    least = std::min(least, stiffness);
    most = std::max(most, stiffness);
  }
  return most / least;
}

// What the elimination of a piece leaves for its ancestors: places in the order, and their Schur
// update.
struct Update {
  std::vector<Index> places;
  Dense values;
};

// The matrix of one piece: its own nodes first, then its border.
struct Front {
  std::vector<Index> places;
  Dense values;  ///< lower triangle by blocks
};

}  // namespace

// Multifrontal elimination of the pieces in their order.
class HalfFactorBuilder {
 public:
  HalfFactorBuilder(const BlockMatrix& a, const EliminationTree& tree)
      : a_(a),
        tree_(tree),
        place_(std::size_t(a.pattern->node_count()), -1),
        local_(tree.order.size(), -1) {
    for (std::size_t k = 0; k < tree.order.size(); ++k)
      place_[std::size_t(tree.order[k])] = static_cast<Index>(k);
    children_.resize(std::size_t(tree.piece_count()));
    for (Index piece = 0; piece < tree.piece_count(); ++piece)
      if (tree.parent[std::size_t(piece)] >= 0)
        children_[std::size_t(tree.parent[std::size_t(piece)])].push_back(piece);
    updates_.resize(children_.size());
  }

  // S, B and the border of a piece; false if its own block is not positive definite.
  bool eliminate(Index piece, std::vector<Index>& border, Dense& s, Dense& b) {
    Front front = assemble(piece);
    const Index own = tree_.begin[std::size_t(piece) + 1] - tree_.begin[std::size_t(piece)];
    const Eigen::Index c = 3 * Eigen::Index{own}, r = 3 * Eigen::Index(front.places.size()) - c;
    const Eigen::LLT<Dense> llt(front.values.topLeftCorner(c, c));
    if (llt.info() != Eigen::Success) return false;
    s = llt.solve(Dense::Identity(c, c));
    if (!s.allFinite()) return false;
    // With X = A_rc L^-T: B = X L^-1, and the update is -X X^T.
    Dense x = front.values.bottomLeftCorner(r, c);
    llt.matrixL().transpose().solveInPlace<Eigen::OnTheRight>(x);
    Update& update = updates_[std::size_t(piece)];
    update.places.assign(front.places.begin() + own, front.places.end());
    update.values = front.values.bottomRightCorner(r, r);
    update.values.selfadjointView<Eigen::Lower>().rankUpdate(x, -1.0);
    b = std::move(x);
    llt.matrixL().solveInPlace<Eigen::OnTheRight>(b);
    border = update.places;
    return true;
  }

 private:
  Front assemble(Index piece) {
    Front front;
    const Index begin = tree_.begin[std::size_t(piece)], end = tree_.begin[std::size_t(piece) + 1];
    for (Index k = begin; k < end; ++k) add_place(k, front.places);
    const std::size_t own = front.places.size();
    for (Index k = begin; k < end; ++k)
      for_later(k, begin, [&](Index place, Index) { add_place(place, front.places); });
    for (const Index child : children_[std::size_t(piece)])
      for (const Index place : updates_[std::size_t(child)].places) add_place(place, front.places);
    std::sort(front.places.begin() + std::ptrdiff_t(own), front.places.end());
    for (std::size_t k = 0; k < front.places.size(); ++k)
      local_[std::size_t(front.places[k])] = static_cast<Index>(k);
    front.values.setZero(3 * Eigen::Index(front.places.size()), 3 * Eigen::Index(front.places.size()));
    for (Index k = begin; k < end; ++k)
      for_later(k, begin, [&](Index place, Index block) {
        front.values.block<3, 3>(3 * local_[std::size_t(place)], 3 * (k - begin)) =
            a_.block(block).transpose();
      });
    for (const Index child : children_[std::size_t(piece)]) add_update(child, front);
    for (const Index place : front.places) local_[std::size_t(place)] = -1;
    return front;
  }

  void add_place(Index place, std::vector<Index>& places) {
    if (local_[std::size_t(place)] >= 0) return;
    local_[std::size_t(place)] = 0;
    places.push_back(place);
  }

  // The blocks below the diagonal of a node's column within the part (A is symmetric: its row), and
  // those inside the piece that begins at `begin`.
  template <class Visit>
  void for_later(Index place, Index begin, Visit&& visit) const {
    const Index node = tree_.order[std::size_t(place)];
    for (Index b = a_.pattern->row_begin[std::size_t(node)];
         b < a_.pattern->row_begin[std::size_t(node) + 1]; ++b) {
      const Index other = place_[std::size_t(a_.pattern->column[std::size_t(b)])];
      if (other >= begin) visit(other, b);
    }
  }

  void add_update(Index child, Front& front) {
    Update& update = updates_[std::size_t(child)];
    const auto count = Eigen::Index(update.places.size());
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index i = j; i < count; ++i) {
        const Index row = local_[std::size_t(update.places[std::size_t(i)])];
        const Index col = local_[std::size_t(update.places[std::size_t(j)])];
        if (i == j) {
          Mat3 block = update.values.block<3, 3>(3 * i, 3 * i).selfadjointView<Eigen::Lower>();
          front.values.block<3, 3>(3 * row, 3 * row) += block;
        } else {
          front.values.block<3, 3>(3 * row, 3 * col) += update.values.block<3, 3>(3 * i, 3 * j);
        }
      }
    update = {};
  }

  const BlockMatrix& a_;
  const EliminationTree& tree_;
  std::vector<Index> place_;  ///< in the order, by node; -1: not in the part
  std::vector<Index> local_;  ///< in the front, by place
  std::vector<std::vector<Index>> children_;
  std::vector<Update> updates_;
};

bool HalfFactor::create(const BlockMatrix& a, std::span<const Point> positions,
                        std::span<const Index> nodes) {
  const EliminationTree tree = nested_dissection(*a.pattern, positions, nodes, leaf_nodes);
  HalfFactorBuilder builder(a, tree);
  order_ = tree.order;
  Dense s, b;
  std::vector<Index> border, places;
  for (Index k = 0; k < tree.piece_count(); ++k) {
    if (!builder.eliminate(k, border, s, b)) return false;
    const Index begin = tree.begin[std::size_t(k)], end = tree.begin[std::size_t(k) + 1];
    places = border;
    for (Index place = begin; place < end; ++place) places.push_back(place);
    add_piece(begin, end, border, s, b, contrast_of(a, order_, places) <= largest_contrast);
  }
  return true;
}

void HalfFactor::add_piece(Index begin, Index end, const std::vector<Index>& border, const Dense& s,
                           const Dense& b, bool in_integers) {
  Piece piece;
  piece.begin = begin;
  piece.end = end;
  piece.border_begin = border_.size();
  piece.border_count = border.size();
  border_.insert(border_.end(), border.begin(), border.end());
  piece.inverse_begin = values_.size();
  piece.inverse_scale = float(s.cwiseAbs().maxCoeff());
  append_half_columns(s / double(piece.inverse_scale));
  piece.coupling_begin = values_.size();
  piece.in_integers = in_integers;
  if (piece.in_integers)
    piece.coupling = append_integers(b, values_);
  else
    append_half_columns(b);
  largest_border_ =
      std::max({largest_border_, padded(3 * border.size()), padded(std::size_t(s.rows()))});
  pieces_.push_back(piece);
}

void HalfFactor::append_half_columns(const Dense& matrix) {
  std::vector<float> column;
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    column.assign(padded(std::size_t(matrix.rows())), 0.0F);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) column[std::size_t(i)] = float(matrix(i, j));
    append_halves(column, values_);
  }
}

IntegerBlock HalfFactor::coupling_of(const Piece& piece) const {
  IntegerBlock block = piece.coupling;
  block.values = values_.data() + piece.coupling_begin;
  return block;
}

// x_r -= B x_c.
void HalfFactor::forward(const Piece& piece, float* x, float* work) const {
  if (piece.border_count == 0) return;
  const std::size_t own = 3 * std::size_t(piece.end - piece.begin);
  const std::size_t rows = padded(3 * piece.border_count);
  const float* own_x = x + 3 * piece.begin;
  std::fill_n(work, rows, 0.0F);
  if (piece.in_integers)
    add_product(coupling_of(piece), own_x, work, work + largest_border_);
  else
    add_product(values_.data() + piece.coupling_begin, rows, own, own_x, work);
  const Index* border = border_.data() + piece.border_begin;
  for (std::size_t k = 0; k < piece.border_count; ++k)
    for (std::size_t i = 0; i < 3; ++i) x[3 * std::size_t(border[k]) + i] -= work[3 * k + i];
}

// x_c = S x_c - B^T x_r.
void HalfFactor::backward(const Piece& piece, float* x, float* work) const {
  const std::size_t own = 3 * std::size_t(piece.end - piece.begin), own_rows = padded(own);
  const std::size_t rows = padded(3 * piece.border_count);
  float *own_x = x + 3 * piece.begin, *border_x = work + largest_border_;
  std::fill_n(work, own_rows, 0.0F);
  add_product(values_.data() + piece.inverse_begin, own_rows, own, own_x, work);
  const Index* border = border_.data() + piece.border_begin;
  std::fill_n(border_x + 3 * piece.border_count, rows - 3 * piece.border_count, 0.0F);
  for (std::size_t k = 0; k < piece.border_count; ++k)
    for (std::size_t i = 0; i < 3; ++i) border_x[3 * k + i] = x[3 * std::size_t(border[k]) + i];
  for (std::size_t i = 0; i < own; ++i) own_x[i] = piece.inverse_scale * work[i];
  if (piece.border_count == 0) return;
  if (piece.in_integers)
    subtract_transposed_product(coupling_of(piece), border_x, own_x, work);
  else
    subtract_transposed_product(values_.data() + piece.coupling_begin, rows, own, border_x, own_x);
}

void HalfFactor::solve(float* x, float* work) const {
  for (const Piece& piece : pieces_) forward(piece, x, work);
  for (std::size_t k = pieces_.size(); k-- > 0;) backward(pieces_[k], x, work);
}

std::size_t HalfFactor::bytes() const {
  return values_.size() * sizeof(values_[0]) + pieces_.size() * sizeof(Piece) +
         (order_.size() + border_.size()) * sizeof(Index);
}

}  // namespace souple
