// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/selected_inverse.hpp"

#include <algorithm>

namespace souple {
namespace {

/// Fronts from the last supernode to the first, which is from the roots down: the inverse on a
/// supernode's rows. A front is let go when the last child has read it.
class FrontWalk {
 public:
  explicit FrontWalk(const SingleFactor& factor) : factor_(factor), open_children_(factor.count(), 0) {
    for (std::size_t s = 0; s < factor.count(); ++s)
      if (factor.reached(s) && factor.parent(s) >= 0) ++open_children_[std::size_t(factor.parent(s))];
  }
  bool keeps_front(std::size_t s) const { return open_children_[s] > 0; }
  /// After child `s` has read its parent's front: true if that was the last one.
  bool last_reader(std::size_t s) { return --open_children_[std::size_t(factor_.parent(s))] == 0; }

 private:
  const SingleFactor& factor_;
  std::vector<std::int64_t> open_children_;
};

class SelectedInverse {
 public:
  SelectedInverse(const SingleFactor& factor, std::span<const std::int64_t> places)
      : factor_(factor),
        walk_(factor),
        front_(factor.count()),
        result_(places.size(), Mat3::Zero()),
        node_at_(std::size_t(factor.size()), -1) {
    for (std::size_t k = 0; k < places.size(); ++k) node_at_[std::size_t(places[k])] = std::int64_t(k);
  }

  std::vector<Mat3> run(const std::function<bool()>& cancelled) {
    for (std::size_t s = factor_.count(); s-- > 0;) {
      if (!factor_.reached(s)) continue;
      if (cancelled && cancelled()) return {};
      visit(s);
    }
    return std::move(result_);
  }

 private:
  // With L = (L11; L21), T = L21 L11^-1 and Z22 known: Z21 = -Z22 T, Z11 = (L11 L11^T)^-1 - T^T Z21.
  void visit(std::size_t s) {
    const Eigen::Index own = factor_.columns(s), below = factor_.below(s);
    Eigen::MatrixXf front(own + below, own + below);
    if (below > 0) read_parent(s, front.bottomRightCorner(below, below));
    Eigen::MatrixXf t = factor_.block_below(s);
    solve_right(factor_.diagonal_block(s), false, t);
    front.topLeftCorner(own, own) = factor_.diagonal_block(s);
    inverse_of_cholesky(front.topLeftCorner(own, own));
    front.bottomLeftCorner(below, own).setZero();
    add_product(-1, front.bottomRightCorner(below, below), t, front.bottomLeftCorner(below, own));
    add_transposed_product(-1, t, front.bottomLeftCorner(below, own), front.topLeftCorner(own, own));
    front.topRightCorner(own, below) = front.bottomLeftCorner(below, own).transpose();
    store_blocks(s, front);
    if (walk_.keeps_front(s)) front_[s] = std::move(front);
  }

  void read_parent(std::size_t s, Eigen::Ref<Eigen::MatrixXf> out) {
    const auto parent = std::size_t(factor_.parent(s));
    const auto rows = factor_.rows(s).subspan(std::size_t(factor_.columns(s)));
    const auto parent_rows = factor_.rows(parent);
    place_.resize(rows.size());
    std::size_t at = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      while (parent_rows[at] != rows[k]) ++at;
      place_[k] = Eigen::Index(at);
    }
    const Eigen::MatrixXf& from = front_[parent];
    for (std::size_t c = 0; c < rows.size(); ++c)
      for (std::size_t r = 0; r < rows.size(); ++r)
        out(Eigen::Index(r), Eigen::Index(c)) = from(place_[r], place_[c]);
    if (walk_.last_reader(s)) front_[parent].resize(0, 0);
  }

  void store_blocks(std::size_t s, const Eigen::MatrixXf& front) {
    for (Eigen::Index c = 0; c < factor_.columns(s); ++c) {
      const std::int64_t node = node_at_[std::size_t(factor_.first_column(s) + c)];
      if (node < 0 || c + 3 > front.cols()) continue;
      const Mat3 block = front.block<3, 3>(c, c).cast<double>();
      result_[std::size_t(node)] = 0.5 * (block + block.transpose());
    }
  }

  const SingleFactor& factor_;
  FrontWalk walk_;
  std::vector<Eigen::MatrixXf> front_;
  std::vector<Mat3> result_;
  std::vector<std::int64_t> node_at_;
  std::vector<Eigen::Index> place_;
};

}  // namespace

std::vector<Mat3> inverse_diagonal_blocks(const SingleFactor& factor,
                                          std::span<const std::int64_t> places,
                                          const std::function<bool()>& cancelled) {
  return SelectedInverse(factor, places).run(cancelled);
}

std::size_t selected_inverse_bytes(const SingleFactor& factor) {
  FrontWalk walk(factor);
  std::size_t held = 0, peak = 0;
  const auto front_bytes = [&](std::size_t s) {
    const auto rows = std::size_t(factor.columns(s) + factor.below(s));
    return rows * rows * sizeof(float);
  };
  for (std::size_t s = factor.count(); s-- > 0;) {
    if (!factor.reached(s)) continue;
    const std::size_t t_bytes = std::size_t(factor.below(s) * factor.columns(s)) * sizeof(float);
    peak = std::max(peak, held + front_bytes(s) + t_bytes);
    if (factor.parent(s) >= 0 && walk.last_reader(s))
      held -= front_bytes(std::size_t(factor.parent(s)));
    if (walk.keeps_front(s)) held += front_bytes(s);
  }
  return peak;
}

}  // namespace souple
