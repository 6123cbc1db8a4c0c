// SPDX-License-Identifier: MIT
#include "runtime/fem/node_gather.hpp"

#include <algorithm>

#include "runtime/fem/rotation_lanes.hpp"

namespace souple {

NodeGather::NodeGather(Index node_count, std::span<const Tet> tets)
    : begin_(std::size_t(node_count) + 1, 0), corners_(4 * tets.size()) {
  for (const Tet& tet : tets)
    for (const Index node : tet) ++begin_[std::size_t(node) + 1];
  for (std::size_t node = 0; node + 1 < begin_.size(); ++node) begin_[node + 1] += begin_[node];
  std::vector<Index> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i)
      corners_[std::size_t(next[std::size_t(tets[t][i])]++)] = static_cast<Index>(4 * t + i);
}

void NodeGather::add_corners(std::span<const CornerVector> corners, IndexRange nodes,
                             double* sums) const {
  for (Index node = nodes.begin; node < nodes.end; ++node) {
    double* to = sums + 3 * std::ptrdiff_t{node};
    Lanes sum = load3(to);
    for (Index k = begin_[node]; k < begin_[node + 1]; ++k)
      sum = sum + _mm256_load_pd(corners[std::size_t(corners_[k])].entry);
    store3(to, sum);
  }
}

Mat3 NodeGather::weighted_sum(std::span<const Mat3> tet_rotations, std::span<const double> volumes,
                              Index node) const {
  Lanes low = zero_lanes(), high = zero_lanes();
  double last = 0;
  for (Index k = begin_[node]; k < begin_[node + 1]; ++k) {
    const auto tet = std::size_t(corners_[k]) / 4;
    const double* r = tet_rotations[tet].data();
    low = fma(all_lanes(volumes[tet]), _mm256_loadu_pd(r), low);
    high = fma(all_lanes(volumes[tet]), _mm256_loadu_pd(r + 4), high);
    last += volumes[tet] * r[8];
  }
  Mat3 sum;
  _mm256_storeu_pd(sum.data(), low);
  _mm256_storeu_pd(sum.data() + 4, high);
  sum.data()[8] = last;
  return sum;
}

void NodeGather::mean_rotations(std::span<const Mat3> tet_rotations, std::span<const double> volumes,
                                IndexRange nodes, Mat3* out) const {
  constexpr Index tile_nodes = lane_count * tile_packs;
  for (Index begin = nodes.begin; begin < nodes.end; begin += tile_nodes) {
    const Index count = std::min(tile_nodes, nodes.end - begin);
    const int pack_count = (count + lane_count - 1) / lane_count;
    Mat3 sums[tile_nodes];
    for (Index k = 0; k < lane_count * pack_count; ++k)
      sums[k] = weighted_sum(tet_rotations, volumes, begin + std::min(k, count - 1));
    LaneMat3 f[tile_packs];
    LaneRotations found[tile_packs];
    for (int pack = 0; pack < pack_count; ++pack) f[pack] = load_matrices(sums + lane_count * pack);
    rotations_of<RotationMethod::polar>(f, pack_count, found);
    for (int pack = 0; pack < pack_count; ++pack)
      store_rotations(f[pack], found[pack], std::min(lane_count, count - lane_count * pack),
                      out + begin + lane_count * pack);
  }
}

}  // namespace souple
