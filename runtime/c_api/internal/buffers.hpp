// SPDX-License-Identifier: MIT
// Results into the caller's memory: (buffer, capacity, needed), and structs that grow with versions.
#pragma once
#include <algorithm>
#include <cstring>
#include <string>

#include "runtime/c_api/internal/refusal.hpp"

namespace souple::c_api {

/// Whether the entries may be written; false without an issue: the count alone was asked for.
Result<bool> may_fill(const void* buffer, std::size_t capacity, std::size_t* needed, std::size_t count);

/// buffer[i] = entry(i), i < count.
template <class T, class Entry>
Status fill(T* buffer, std::size_t capacity, std::size_t* needed, std::size_t count, Entry&& entry) {
  const auto may = may_fill(buffer, capacity, needed, count);
  if (!may) return may.issue();
  if (*may)
    for (std::size_t i = 0; i < count; ++i) buffer[i] = entry(i);
  return {};
}

/// Bytes of the first version of a struct, which callers of today were compiled with (64 bits).
template <class T>
inline constexpr std::size_t first_size = 0;
template <>
inline constexpr std::size_t first_size<souple_load_options> = 64;
template <>
inline constexpr std::size_t first_size<souple_asset_facts> = 112;
template <>
inline constexpr std::size_t first_size<souple_compliance_facts> = 40;
template <>
inline constexpr std::size_t first_size<souple_world_settings> = 136;
template <>
inline constexpr std::size_t first_size<souple_soft_body_description> = 152;
template <>
inline constexpr std::size_t first_size<souple_rigid_body_description> = 216;
template <>
inline constexpr std::size_t first_size<souple_load_description> = 96;
template <>
inline constexpr std::size_t first_size<souple_joint_description> = 96;
template <>
inline constexpr std::size_t first_size<souple_step_report> = 240;
template <>
inline constexpr std::size_t first_size<souple_jaw_description> = 264;
template <>
inline constexpr std::size_t first_size<souple_tool_description> = 104;
template <>
inline constexpr std::size_t first_size<souple_haptic_settings> = 152;
template <>
inline constexpr std::size_t first_size<souple_haptic_telemetry> = 1800;

/// Issue api_struct_size_invalid unless a struct of `size` bytes can be one of at least `first`.
Status check_struct_size(std::size_t size, std::size_t first, const char* name);
/// The same if a caller's newer struct says nothing in the bytes that are not known here.
Status check_rest(const void* given, std::size_t size, std::size_t known, const char* name);

/// The init function of a struct: `defaults`, and zeros in what is not known here.
template <class T>
Status init_struct(T* out, std::size_t size, const T& defaults, const char* name) {
  static_assert(sizeof(T) >= first_size<T> && first_size<T> > 0);
  if (auto status = need({{out, name}}); !status) return status;
  if (auto status = check_struct_size(size, first_size<T>, name); !status) return status;
  std::memset(static_cast<void*>(out), 0, size);
  std::memcpy(static_cast<void*>(out), &defaults, std::min(size, sizeof(T)));
  out->struct_size = static_cast<std::uint32_t>(size);
  return {};
}

/// A caller's struct over the defaults, which stand for fields that its version does not have.
template <class T>
Result<T> read_struct(const T* given, const T& defaults, const char* name) {
  if (auto status = need({{given, name}}); !status) return status.issue();
  const std::size_t size = given->struct_size;
  if (auto status = check_struct_size(size, first_size<T>, name); !status) return status.issue();
  if (auto status = check_rest(given, size, sizeof(T), name); !status) return status.issue();
  T read = defaults;
  std::memcpy(static_cast<void*>(&read), given, std::min(size, sizeof(T)));
  return read;
}

/// Writes what the caller's version of the struct has of `value`.
template <class T>
Status write_struct(T* out, T value, const char* name) {
  if (auto status = need({{out, name}}); !status) return status;
  const std::size_t size = out->struct_size;
  if (auto status = check_struct_size(size, first_size<T>, name); !status) return status;
  value.struct_size = out->struct_size;
  std::memcpy(static_cast<void*>(out), &value, std::min(size, sizeof(T)));
  return {};
}

}  // namespace souple::c_api
