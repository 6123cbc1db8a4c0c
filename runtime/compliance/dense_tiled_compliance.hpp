// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/compliance/rest_compliance.hpp"

namespace souple {

/// Where the tiles of ComplianceRepresentation::dense_tiled stand.
struct TileLayout {
  Index node_count = 0;
  Index tile_nodes = 0;

  std::int64_t tile_count() const { return (std::int64_t{node_count} + tile_nodes - 1) / tile_nodes; }
  std::int64_t block_count() const { return tile_count() * (tile_count() + 1) / 2; }
  std::int64_t block_scalars() const { return 9 * std::int64_t{tile_nodes} * tile_nodes; }
  /// Block of tile (i, j), j <= i.
  static std::int64_t block_index(std::int64_t i, std::int64_t j) { return i * (i + 1) / 2 + j; }
};

/// C0 as plain scalars in tiles of its lower triangle.
template <class Scalar>
class DenseTiledCompliance final : public RestCompliance {
 public:
  DenseTiledCompliance(TileLayout layout, std::unique_ptr<BlockSource> source);

  Index row_count() const override { return layout_.node_count; }
  bool ready(std::span<const Index> rows) const override;
  void gather(std::span<const Index> rows, std::span<double> out) const override;
  void gather_block(std::span<const Index> rows, std::span<const Index> columns, float* out,
                    std::size_t stride, ComplianceWork& work) const override;
  void apply(std::span<const Index> rows, std::span<const double> force, std::span<double> displacement,
             ComplianceWork& work) const override;
  std::size_t resident_bytes() const override { return source_->resident_bytes(); }

 private:
  const Scalar* tile(std::int64_t i, std::int64_t j) const;
  Mat3 node_block(Index row, Index column) const;

  TileLayout layout_;
  std::unique_ptr<BlockSource> source_;
};

}  // namespace souple
