// SPDX-License-Identifier: MIT
// The C++ rows that datasets hold, and their HDF5 scalar type and width.
#pragma once
#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "formats/core/mesh.hpp"

namespace souple::storage {

/// Scalar type in the file; columns = 0 means a dataset of rank 1.
struct RowType {
  hid_t scalar = H5I_INVALID_HID;
  std::size_t scalar_bytes = 0;
  std::size_t columns = 0;
};

inline RowType row_type(const Index*) { return {H5T_STD_I32LE, 4, 0}; }
inline RowType row_type(const std::int64_t*) { return {H5T_STD_I64LE, 8, 0}; }
inline RowType row_type(const std::uint8_t*) { return {H5T_STD_U8LE, 1, 0}; }
inline RowType row_type(const std::byte*) { return {H5T_STD_U8LE, 1, 0}; }
inline RowType row_type(const float*) { return {H5T_IEEE_F32LE, 4, 0}; }
inline RowType row_type(const double*) { return {H5T_IEEE_F64LE, 8, 0}; }
template <std::size_t N>
RowType row_type(const std::array<Index, N>*) {
  return {H5T_STD_I32LE, 4, N};
}
template <std::size_t N>
RowType row_type(const std::array<std::uint8_t, N>*) {
  return {H5T_STD_U8LE, 1, N};
}
template <std::size_t N>
RowType row_type(const std::array<float, N>*) {
  return {H5T_IEEE_F32LE, 4, N};
}
template <std::size_t N>
RowType row_type(const std::array<double, N>*) {
  return {H5T_IEEE_F64LE, 8, N};
}

}  // namespace souple::storage
