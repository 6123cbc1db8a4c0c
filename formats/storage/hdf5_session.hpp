// SPDX-License-Identifier: MIT
// Orderly use of the HDF5 C library: one thread at a time, silent, no handle left open.
#pragma once
#include <hdf5.h>

#include <mutex>
#include <utility>

namespace souple::storage {

/// Held by every public function around its HDF5 calls. Debian's serial HDF5 is not thread-safe, so all
/// readers and writers of the process share one mutex. The application's error printing is switched off
/// meanwhile, and the zstd filter is registered.
class Hdf5Session {
 public:
  Hdf5Session();
  ~Hdf5Session();
  Hdf5Session(const Hdf5Session&) = delete;
  Hdf5Session& operator=(const Hdf5Session&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

/// Owns one HDF5 identifier of any kind; a negative one (a failed call) owns nothing.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() { close(); }

  explicit operator bool() const { return id_ >= 0; }
  hid_t get() const { return id_; }
  /// False if HDF5 could not complete what was pending.
  bool close() { return id_ < 0 || H5Idec_ref(std::exchange(id_, H5I_INVALID_HID)) >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

}  // namespace souple::storage
