// SPDX-License-Identifier: GPL-3.0-or-later
// Other ways to P^T A P than the one that ships (GalerkinPlan), to compare it with. All give both
// halves.
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/multigrid/prolongation.hpp"
#include "tests/bench/galerkin_bodies.hpp"

namespace souple::bench {

/// One product of one level; coarse values on the pattern that it was made with.
class GalerkinMethod {
 public:
  virtual ~GalerkinMethod() = default;
  virtual void compute(const BlockMatrixF& fine, BlockMatrixF& coarse) = 0;
  virtual std::size_t bytes() const = 0;
};

/// The two ways that GalerkinPlan chooses from, whatever it chooses.
std::unique_ptr<GalerkinMethod> multiplied_out(const BlockPattern& fine, const Prolongation& p,
                                               const BlockPattern& coarse);
std::unique_ptr<GalerkinMethod> by_rows(const BlockPattern& fine, const Prolongation& p,
                                        const BlockPattern& coarse);
/// One list a coarse block of the upper half: fine blocks of both halves and their weights.
std::unique_ptr<GalerkinMethod> fused_list(const BlockPattern& fine, const Prolongation& p,
                                           const BlockPattern& coarse);
/// The thesis (METHOD 3.1): for every block of A P the pairs to multiply, then for every one of P^T (A
/// P).
std::unique_ptr<GalerkinMethod> two_plans(const BlockPattern& fine, const Prolongation& p,
                                          const BlockPattern& coarse);
/// Gustavson's algorithm for both products, with the patterns known: no lists, a table of places a row.
std::unique_ptr<GalerkinMethod> gustavson(const BlockPattern& fine, const Prolongation& p,
                                          const BlockPattern& coarse);

/// Sums the rotated stiffness of the finest elements straight into the matrix of the level below, eight
/// coarse tets at a time. For levels whose midpoints stay: the coarse functions are linear
/// in the whole coarse tet, so that a child has four of them.
class ElementProducts {
 public:
  ElementProducts(const GalerkinBody& body, const BlockPattern& coarse);
  using Rotation = std::array<float, 9>;  ///< row-major
  void compute(std::span<const Rotation> rotations, BlockMatrixF& coarse) const;
  std::size_t bytes() const;

 private:
  struct CoarseTet {
    std::array<std::array<float, 3>, 4> gradients;  ///< 1/m
    float child_volume;                             ///< m^3
    std::array<Index, 16> block;                    ///< of (i, j)
  };
  std::vector<CoarseTet> tets_;
  std::vector<float> mass_;  ///< of every coarse block: P^T M P times the mass factor
};

template <class Scalar>
using EigenMatrix = Eigen::SparseMatrix<Scalar, Eigen::RowMajor, int>;
template <class Scalar>
EigenMatrix<Scalar> eigen_matrix(const BlockMatrixF& a);
template <class Scalar>
EigenMatrix<Scalar> eigen_matrix(const Prolongation& p);

/// Largest entry of the difference over the largest entry.
double relative_difference(const BlockMatrixF& a, const BlockMatrixF& b);

}  // namespace souple::bench
