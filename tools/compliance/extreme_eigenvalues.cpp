// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/extreme_eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <random>

namespace souple {
namespace {

using Eigen::MatrixXd;

MatrixXd random_start(Eigen::Index size, Eigen::Index columns) {
  std::mt19937 random(20);
  std::normal_distribution<double> normal;
  MatrixXd start(size, columns);
  for (Eigen::Index k = 0; k < start.size(); ++k) start.data()[k] = normal(random);
  return start;
}

void orthonormalise_columns(MatrixXd& a) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  a = qr.householderQ() * MatrixXd::Identity(a.rows(), a.cols());
}

}  // namespace

EigenvalueRange extreme_eigenvalues(const BlockProduct& product, Eigen::Index size,
                                    Eigen::Index block_columns, int steps) {
  const Eigen::Index width = std::min(block_columns, size);
  const Eigen::Index most = std::min(size / width, Eigen::Index{steps});
  MatrixXd basis(size, most * width), ritz = MatrixXd::Zero(most * width, most * width);
  MatrixXd next = random_start(size, width), image;
  for (Eigen::Index k = 0; k < most; ++k) {
    const Eigen::Index known = k * width;
    auto old = basis.leftCols(known);
    // Twice is enough (Kahan, Parlett); the second time also against what the first left over.
    for (int pass = 0; pass < 2; ++pass) {
      next -= (old * (old.transpose() * next)).eval();
      orthonormalise_columns(next);
    }
    basis.middleCols(known, width) = next;
    image.setZero(size, width);
    product(next, image);
    auto all = basis.leftCols(known + width);
    ritz.block(0, known, known + width, width) = all.transpose() * image;
    next = image;
  }
  const MatrixXd upper = ritz.triangularView<Eigen::Upper>();
  const MatrixXd symmetric = upper + MatrixXd(upper.triangularView<Eigen::StrictlyUpper>().transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric, Eigen::EigenvaluesOnly);
  return {solver.eigenvalues().minCoeff(), solver.eigenvalues().maxCoeff()};
}

}  // namespace souple
