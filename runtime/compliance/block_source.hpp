// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
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
  /// Asks for a block that is not ready, so that it will be; does not wait. Callable from the real-time
  /// thread: no lock, no I/O, no allocation. Asking again, or for a block that is ready, does nothing.
  /// A compliance asks for what its ready() misses, so that a step that was refused can be tried again.
  virtual void request(std::size_t /*index*/) {}
  virtual std::size_t resident_bytes() const = 0;
};

/// All blocks in memory, one after another.
class MemoryBlockSource final : public BlockSource {
 public:
  /// Blocks of one size.
  MemoryBlockSource(std::vector<std::byte> payload, std::size_t block_bytes)
      : payload_(std::move(payload)), block_bytes_(block_bytes) {}
  /// Block i is [begins[i], begins[i + 1]); the begins ascend from 0 to the size of the payload.
  MemoryBlockSource(std::vector<std::byte> payload, std::vector<std::int64_t> begins)
      : payload_(std::move(payload)), begins_(std::move(begins)) {}

  bool ready(std::size_t index) const override {
    return begins_.empty() ? (index + 1) * block_bytes_ <= payload_.size()
                           : index + 1 < begins_.size() && begin_of(index + 1) <= payload_.size();
  }
  std::span<const std::byte> block(std::size_t index) const override {
    const std::size_t begin = begin_of(index);
    return std::span(payload_).subspan(begin, begin_of(index + 1) - begin);
  }
  std::size_t resident_bytes() const override {
    return payload_.size() + begins_.size() * sizeof(std::int64_t);
  }

 private:
  std::size_t begin_of(std::size_t index) const {
    return begins_.empty() ? index * block_bytes_ : static_cast<std::size_t>(begins_[index]);
  }

  std::vector<std::byte> payload_;
  std::size_t block_bytes_ = 0;
  std::vector<std::int64_t> begins_;  ///< empty: all of block_bytes_
};

}  // namespace souple
