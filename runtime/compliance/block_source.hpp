// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// Hands out the encoded blocks of one compliance variant. The runtime never reads a file: this source
/// holds them, or a streaming one fetches ahead on another thread.
class BlockSource {
 public:
  virtual ~BlockSource() = default;
  /// Whether block(index) may be called now. Called from the real-time thread: no wait, no I/O.
  virtual bool ready(std::size_t index) const = 0;
  /// Encoded bytes of a block that is ready; valid as long as the source.
  virtual std::span<const std::byte> block(std::size_t index) const = 0;
  virtual std::size_t resident_bytes() const = 0;
};

/// All blocks in memory, each of the same size.
class MemoryBlockSource final : public BlockSource {
 public:
  MemoryBlockSource(std::vector<std::byte> payload, std::size_t block_bytes)
      : payload_(std::move(payload)), block_bytes_(block_bytes) {}
  bool ready(std::size_t index) const override { return (index + 1) * block_bytes_ <= payload_.size(); }
  std::span<const std::byte> block(std::size_t index) const override {
    return std::span(payload_).subspan(index * block_bytes_, block_bytes_);
  }
  std::size_t resident_bytes() const override { return payload_.size(); }

 private:
  std::vector<std::byte> payload_;
  std::size_t block_bytes_;
};

}  // namespace souple
