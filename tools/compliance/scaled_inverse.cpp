// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/scaled_inverse.hpp"

#include "tools/compliance/block_sampler.hpp"

namespace souple {
namespace {

// Far below what single precision resolves of a product.
constexpr double refined_tolerance = 1e-10;
constexpr Eigen::Index deflated_columns = 16;  // of one task
constexpr int smoothing_passes = 3;
constexpr std::uint64_t smooth_key = 1000;  // of random signs that no level uses

}  // namespace

ScaledInverse::ScaledInverse(const SurfaceInverse& inverse, std::span<const Index> order,
                             std::span<const Mat3> scale)
    : inverse_(inverse) {
  for (const Index node : order) {
    places_.push_back(inverse.places()[std::size_t(node)]);
    unscale_.push_back(scale[std::size_t(node)].triangularView<Eigen::Lower>().solve(Mat3::Identity()));
  }
}

template <class Matrix>
void ScaledInverse::to_forces(Matrix& x) const {
  using Scalar = typename Matrix::Scalar;
  Eigen::Matrix<Scalar, 3, Eigen::Dynamic> part;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    part = unscale_[k].transpose().cast<Scalar>() * x.middleRows(3 * Eigen::Index(k), 3);
    x.middleRows(3 * Eigen::Index(k), 3) = part;
  }
}

template <class Matrix>
void ScaledInverse::from_displacements(Matrix& x) const {
  using Scalar = typename Matrix::Scalar;
  Eigen::Matrix<Scalar, 3, Eigen::Dynamic> part;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    part = unscale_[k].cast<Scalar>() * x.middleRows(3 * Eigen::Index(k), 3);
    x.middleRows(3 * Eigen::Index(k), 3) = part;
  }
}

void ScaledInverse::apply_refined(Eigen::Ref<Eigen::MatrixXd> x, SurfaceInverse::Work& work) const {
  to_forces(x);
  inverse_.apply_refined(places_, x, refined_tolerance, work);
  x *= inverse_.factor().unit();
  from_displacements(x);
}

void ScaledInverse::apply_plainly(FloatRef x, SurfaceInverse::Work& work) const {
  to_forces(x);
  inverse_.apply_single(places_, x, work);
  from_displacements(x);
}

void ScaledInverse::apply(FloatRef x, SurfaceInverse::Work& work) const {
  if (refined_) {
    Eigen::MatrixXd wide = x.cast<double>();
    apply_refined(wide, work);
    x = wide.cast<float>();
    return;
  }
  if (smooth_.cols() == 0) return apply_plainly(x, work);
  Eigen::MatrixXf t = Eigen::MatrixXf::Zero(smooth_.cols(), x.cols()), z = t;
  add_transposed_product(1, smooth_, x, t);
  add_product(-1, smooth_, t, x);
  add_transposed_product(1, smooth_image_, x, z);
  apply_plainly(x, work);
  // z - V^T C~ P x, so that V is subtracted and added in one product.
  Eigen::MatrixXf image = Eigen::MatrixXf::Zero(t.rows(), t.cols());
  add_transposed_product(1, smooth_, x, image);
  add_product(1, smooth_, z - image, x);
  add_product(1, smooth_image_, t, x);
}

void ScaledInverse::deflate(Eigen::Index count, WorkerPool& pool) {
  count = std::min(count, size());
  std::vector<SurfaceInverse::Work> work(pool.threads());
  Eigen::MatrixXf v(size(), count), triangle;
  fill_signs(smooth_key, 0, 0, v);
  const auto columns_of = [&](std::size_t task) {
    const Eigen::Index begin = Eigen::Index(task) * deflated_columns;
    return v.middleCols(begin, std::min(deflated_columns, count - begin));
  };
  const auto tasks = std::size_t((count + deflated_columns - 1) / deflated_columns);
  for (int pass = 0; pass < smoothing_passes; ++pass) {
    pool.run(tasks,
             [&](std::size_t task, unsigned worker) { apply_plainly(columns_of(task), work[worker]); });
    if (!orthonormalise(v, triangle)) return;
  }
  Eigen::MatrixXf image(size(), count);
  pool.run(tasks, [&](std::size_t task, unsigned worker) {
    Eigen::MatrixXd part = columns_of(task).cast<double>();
    apply_refined(part, work[worker]);
    image.middleCols(Eigen::Index(task) * deflated_columns, part.cols()) = part.cast<float>();
  });
  smooth_ = std::move(v);
  smooth_image_ = std::move(image);
}

}  // namespace souple
