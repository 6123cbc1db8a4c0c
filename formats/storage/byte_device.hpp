// SPDX-License-Identifier: MIT
// Where the bytes of an asset file come from or go to, below HDF5.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/result.hpp"

namespace souple::storage {

class ByteDevice {
 public:
  virtual ~ByteDevice() = default;
  virtual std::uint64_t size() const = 0;

  /// Fills `bytes` from `offset`; false if they are not all there.
  bool read(std::uint64_t offset, std::span<std::byte> bytes) noexcept;
  virtual bool write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept;
  virtual bool resize(std::uint64_t size) noexcept;
  std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  virtual bool fetch(std::uint64_t offset, std::span<std::byte> bytes) noexcept = 0;
  std::uint64_t bytes_read_ = 0;
};

/// Bytes that somebody else keeps alive.
std::unique_ptr<ByteDevice> make_memory_view(std::span<const std::byte> bytes);

/// A regular file, read-only. Issues: io_file_missing, io_cannot_read.
Result<std::unique_ptr<ByteDevice>> open_file_view(const std::filesystem::path& file);

/// A file under construction. Grows by segments, so that a large one is never copied to grow; bytes
/// that nobody wrote are zero.
class SegmentBuffer final : public ByteDevice {
 public:
  std::uint64_t size() const override { return size_; }
  bool write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept override;
  bool resize(std::uint64_t size) noexcept override;
  /// The content in order, without gaps.
  std::vector<std::span<const std::byte>> pieces() const;

 private:
  static constexpr std::size_t segment_bytes = std::size_t{4} << 20;
  bool fetch(std::uint64_t offset, std::span<std::byte> bytes) noexcept override;
  std::vector<std::unique_ptr<std::byte[]>> segments_;
  std::uint64_t size_ = 0;
};

}  // namespace souple::storage
