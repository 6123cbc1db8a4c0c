// SPDX-License-Identifier: MIT
// What an asset may hold at most: one set of bounds for the writer, the reader and validation.
#pragma once
#include <cstddef>
#include <cstdint>

namespace souple::limits {

inline constexpr std::size_t levels = 16;
inline constexpr std::size_t parts = 256;    ///< fixed sets, and compliance variants
inline constexpr std::size_t regions = 256;  ///< of the material
inline constexpr std::size_t name_bytes = 128;
inline constexpr std::size_t text_bytes =
    60000;                                   ///< recipe and other texts: HDF5 attributes end at 64 KiB
inline constexpr double coordinate_m = 1e7;  ///< |x|; products of three stay far from overflow
inline constexpr double embedding_weight = 1e3;       ///< |w|
inline constexpr double embedding_weight_sum = 1e-6;  ///< |sum w - 1|
inline constexpr std::int64_t tile_nodes = 1024;
inline constexpr std::uint64_t nodes = std::uint64_t{1} << 30;  ///< of one level
inline constexpr std::uint64_t tets = std::uint64_t{1} << 29;   ///< of one level
inline constexpr std::uint64_t triangles = 4 * tets;  ///< of a boundary, or of the visual surface
inline constexpr std::uint64_t plan_rows = std::uint64_t{1} << 31;      ///< of a list of a product plan
inline constexpr std::uint64_t payload_bytes = std::uint64_t{1} << 40;  ///< of one variant

}  // namespace souple::limits
