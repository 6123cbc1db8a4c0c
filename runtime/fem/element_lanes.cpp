// SPDX-License-Identifier: MIT
#include "runtime/fem/element_lanes.hpp"

#include <algorithm>

#include "runtime/fem/rotation_lanes.hpp"

namespace souple {
namespace {

/// Positions of one corner of four tets: x, y and z.
SOUPLE_KERNEL void gather(const double* x, const Index* nodes, Lanes (&corner)[3]) {
  Lanes p[lane_count];
  for (int lane = 0; lane < lane_count; ++lane) p[lane] = load3(x + 3 * std::ptrdiff_t{nodes[lane]});
  transpose(p[0], p[1], p[2], p[3]);
  for (int k = 0; k < 3; ++k) corner[k] = p[k];
}

SOUPLE_KERNEL LaneMat3 load_inverse_edges(const PackShape& shape) {
  LaneMat3 inverse;
  for (int k = 0; k < 9; ++k) inverse.m[k / 3][k % 3] = _mm256_load_pd(shape.inverse_edges[k]);
  return inverse;
}

// From edges, so that the place of the body does not enter: F = (x1-x0, x2-x0, x3-x0) times the inverse
// of the same at rest.
SOUPLE_KERNEL LaneMat3 deformation_gradient(const PackShape& shape, const LaneMat3& inverse,
                                            const double* x) {
  Lanes origin[3], corner[3];
  gather(x, shape.node[0], origin);
  LaneMat3 edges;
  for (int k = 0; k < 3; ++k) {
    gather(x, shape.node[k + 1], corner);
    for (int i = 0; i < 3; ++i) edges.m[i][k] = corner[i] - origin[i];
  }
  return product(edges, inverse);
}

/// The first `count` of four matrices; lanes beyond repeat the last.
SOUPLE_KERNEL LaneMat3 load_rotations(const Mat3* first, Index count) {
  if (count == lane_count) return load_matrices(first);
  Mat3 padded[lane_count];
  for (Index lane = 0; lane < lane_count; ++lane) padded[lane] = first[std::min(lane, count - 1)];
  return load_matrices(padded);
}

/// Vectors of corners 1 to 3, the rows of `of_123`; corner 0 is minus their sum.
SOUPLE_KERNEL void store_corners(const LaneMat3& of_123, Index pack, Index count, CornerVector* out) {
  Lanes corner[4][4];
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 3; ++i) corner[i + 1][axis] = of_123.m[i][axis];
    corner[0][axis] = zero_lanes() - (of_123.m[0][axis] + of_123.m[1][axis] + of_123.m[2][axis]);
  }
  CornerVector* first = out + 4 * std::ptrdiff_t{lane_count} * pack;
  for (int i = 0; i < 4; ++i) {
    corner[i][3] = zero_lanes();
    transpose(corner[i][0], corner[i][1], corner[i][2], corner[i][3]);
    for (Index lane = 0; lane < count; ++lane)
      _mm256_store_pd(first[4 * lane + i].entry, corner[i][lane]);
  }
}

/// -V sigma of the strain sym(F R^T) - I, in the frame of the deformed body; and twice the energy.
SOUPLE_KERNEL LaneMat3 minus_weighted_stress(const PackStiffness& stiffness, const LaneMat3& stretch,
                                             Lanes* energy2) {
  const Lanes lambda = _mm256_load_pd(stiffness.lambda), mu = _mm256_load_pd(stiffness.mu);
  LaneMat3 strain, stress;  // both with a minus
  for (int i = 0; i < 3; ++i) {
    strain.m[i][i] = all_lanes(1) - stretch.m[i][i];
    for (int j = i + 1; j < 3; ++j)
      strain.m[i][j] = strain.m[j][i] = all_lanes(-0.5) * (stretch.m[i][j] + stretch.m[j][i]);
  }
  const Lanes pressure = lambda * (strain.m[0][0] + strain.m[1][1] + strain.m[2][2]);
  const Lanes two_mu = mu + mu;
  for (int i = 0; i < 3; ++i) {
    stress.m[i][i] = fma(two_mu, strain.m[i][i], pressure);
    for (int j = i + 1; j < 3; ++j) stress.m[i][j] = stress.m[j][i] = two_mu * strain.m[i][j];
  }
  if (energy2) {
    *energy2 = zero_lanes();
    for (int i = 0; i < 3; ++i)
      *energy2 = *energy2 + dot3(stress.m[i][0], stress.m[i][1], stress.m[i][2], strain.m[i][0],
                                 strain.m[i][1], strain.m[i][2]);
  }
  return stress;
}

/// sqrt(V mu) R grad N_i; row i of `turned` is R grad N of corner i + 1.
SOUPLE_KERNEL void store_gradients(const PackStiffness& stiffness, LaneMat3 turned, Index pack,
                                   Index count, CornerVector* out) {
  const Lanes weight = _mm256_sqrt_pd(_mm256_load_pd(stiffness.mu));
  for (auto& row : turned.m)
    for (Lanes& entry : row) entry = weight * entry;
  store_corners(turned, pack, count, out);
}

SOUPLE_KERNEL void store_forces(const PackStiffness& stiffness, const LaneMat3& f, const LaneMat3& r,
                                const LaneMat3& turned, Index pack, Index count, CornerVector* out) {
  const LaneMat3 stress = minus_weighted_stress(stiffness, product_transposed(f, r), nullptr);
  store_corners(product(turned, stress), pack, count, out);
}

}  // namespace

void ElementLanes::reserve(std::size_t tet_count) {
  const std::size_t pack_count = (tet_count + lane_count - 1) / lane_count;
  shapes_.reserve(pack_count);
  stiffnesses_.reserve(pack_count);
}

void ElementLanes::add(const Tet& tet, const Mat3& inverse_edges, double volume, const Lame& lame) {
  const Index first = tet_count_ % lane_count;
  if (first == 0) {
    shapes_.emplace_back();
    stiffnesses_.emplace_back();
  }
  for (Index lane = first; lane < lane_count; ++lane) {
    for (int k = 0; k < 9; ++k) shapes_.back().inverse_edges[k][lane] = inverse_edges(k / 3, k % 3);
    for (std::size_t i = 0; i < 4; ++i) shapes_.back().node[i][lane] = tet[i];
    stiffnesses_.back().lambda[lane] = volume * lame.lambda;
    stiffnesses_.back().mu[lane] = volume * lame.mu;
  }
  ++tet_count_;
}

std::size_t ElementLanes::bytes() const {
  return shapes_.size() * sizeof(PackShape) + stiffnesses_.size() * sizeof(PackStiffness);
}

template <RotationMethod method>
void ElementLanes::evaluate_by(const double* x, IndexRange packs, const ElementTerms& out) const {
  for (Index begin = packs.begin; begin < packs.end; begin += tile_packs) {
    const int pack_count = std::min(tile_packs, packs.end - begin);
    LaneMat3 f[tile_packs];
    LaneRotations found[tile_packs];
    for (int k = 0; k < pack_count; ++k) {
      const PackShape& shape = shapes_[std::size_t(begin + k)];
      f[k] = deformation_gradient(shape, load_inverse_edges(shape), x);
    }
    rotations_of<method>(f, pack_count, found);
    for (int k = 0; k < pack_count; ++k) {
      const Index pack = begin + k, count = count_in(pack);
      Mat3* rotations = out.rotations + std::ptrdiff_t{lane_count} * pack;
      store_rotations(f[k], found[k], count, rotations);
      if (!out.gradients) continue;
      const LaneMat3 r = found[k].is_good == 15 ? found[k].matrices : load_rotations(rotations, count);
      const LaneMat3 turned = product_transposed(load_inverse_edges(shapes_[std::size_t(pack)]), r);
      const PackStiffness& stiffness = stiffnesses_[std::size_t(pack)];
      store_gradients(stiffness, turned, pack, count, out.gradients);
      store_forces(stiffness, f[k], r, turned, pack, count, out.forces);
    }
  }
}

void ElementLanes::evaluate(const double* x, RotationMethod method, IndexRange packs,
                            const ElementTerms& out) const {
  switch (method) {
    case RotationMethod::polar:
      return evaluate_by<RotationMethod::polar>(x, packs, out);
    case RotationMethod::qr:
      return evaluate_by<RotationMethod::qr>(x, packs, out);
    case RotationMethod::gram_schmidt:
      return evaluate_by<RotationMethod::gram_schmidt>(x, packs, out);
  }
}

void ElementLanes::gradients(const Mat3* rotations, IndexRange packs, CornerVector* out) const {
  for (Index pack = packs.begin; pack < packs.end; ++pack) {
    const Index count = count_in(pack);
    LaneMat3 turned = load_inverse_edges(shapes_[std::size_t(pack)]);
    if (rotations)
      turned = product_transposed(turned,
                                  load_rotations(rotations + std::ptrdiff_t{lane_count} * pack, count));
    store_gradients(stiffnesses_[std::size_t(pack)], turned, pack, count, out);
  }
}

void ElementLanes::forces(const double* x, const Mat3* rotations, IndexRange packs,
                          CornerVector* out) const {
  for (Index pack = packs.begin; pack < packs.end; ++pack) {
    const Index count = count_in(pack);
    const PackShape& shape = shapes_[std::size_t(pack)];
    const LaneMat3 inverse = load_inverse_edges(shape);
    const LaneMat3 r = load_rotations(rotations + std::ptrdiff_t{lane_count} * pack, count);
    store_forces(stiffnesses_[std::size_t(pack)], deformation_gradient(shape, inverse, x), r,
                 product_transposed(inverse, r), pack, count, out);
  }
}

double ElementLanes::energy(const double* x, const Mat3* rotations) const {
  double sum = 0;
  for (Index pack = 0; pack < all_packs().end; ++pack) {
    const Index count = count_in(pack);
    const PackShape& shape = shapes_[std::size_t(pack)];
    const LaneMat3 f = deformation_gradient(shape, load_inverse_edges(shape), x);
    const LaneMat3 r = load_rotations(rotations + std::ptrdiff_t{lane_count} * pack, count);
    Lanes energy2;
    minus_weighted_stress(stiffnesses_[std::size_t(pack)], product_transposed(f, r), &energy2);
    alignas(32) double by_lane[lane_count];
    _mm256_store_pd(by_lane, energy2);
    for (Index lane = 0; lane < count; ++lane) sum += 0.5 * by_lane[lane];
  }
  return sum;
}

}  // namespace souple
