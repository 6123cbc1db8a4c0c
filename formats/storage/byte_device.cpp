// SPDX-License-Identifier: MIT
#include "formats/storage/byte_device.hpp"

#include <algorithm>
#include <cstring>
#include <new>

namespace souple::storage {

bool ByteDevice::read(std::uint64_t offset, std::span<std::byte> bytes) noexcept {
  if (offset > size() || bytes.size() > size() - offset) return false;
  if (bytes.empty()) return true;
  bytes_read_ += bytes.size();
  return fetch(offset, bytes);
}

bool ByteDevice::write(std::uint64_t, std::span<const std::byte>) noexcept { return false; }
bool ByteDevice::resize(std::uint64_t) noexcept { return false; }

namespace {

class MemoryView final : public ByteDevice {
 public:
  explicit MemoryView(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }

 private:
  bool fetch(std::uint64_t offset, std::span<std::byte> bytes) noexcept override {
    std::memcpy(bytes.data(), bytes_.data() + offset, bytes.size());
    return true;
  }
  std::span<const std::byte> bytes_;
};

}  // namespace

std::unique_ptr<ByteDevice> make_memory_view(std::span<const std::byte> bytes) {
  return std::make_unique<MemoryView>(bytes);
}

bool SegmentBuffer::resize(std::uint64_t size) noexcept {
  const std::uint64_t needed = (size + segment_bytes - 1) / segment_bytes;
  try {
    while (segments_.size() < needed) segments_.push_back(std::make_unique<std::byte[]>(segment_bytes));
  } catch (const std::bad_alloc&) {
    return false;
  }
  size_ = size;
  return true;
}

bool SegmentBuffer::write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept {
  if (offset + bytes.size() > size_ && !resize(offset + bytes.size())) return false;
  while (!bytes.empty()) {
    const std::size_t start = offset % segment_bytes;
    const std::size_t count = std::min(bytes.size(), segment_bytes - start);
    std::memcpy(segments_[offset / segment_bytes].get() + start, bytes.data(), count);
    offset += count;
    bytes = bytes.subspan(count);
  }
  return true;
}

bool SegmentBuffer::fetch(std::uint64_t offset, std::span<std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const std::size_t start = offset % segment_bytes;
    const std::size_t count = std::min(bytes.size(), segment_bytes - start);
    std::memcpy(bytes.data(), segments_[offset / segment_bytes].get() + start, count);
    offset += count;
    bytes = bytes.subspan(count);
  }
  return true;
}

std::vector<std::span<const std::byte>> SegmentBuffer::pieces() const {
  std::vector<std::span<const std::byte>> result;
  for (std::uint64_t offset = 0; offset < size_; offset += segment_bytes) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(segment_bytes, size_ - offset));
    result.emplace_back(segments_[offset / segment_bytes].get(), count);
  }
  return result;
}

}  // namespace souple::storage
