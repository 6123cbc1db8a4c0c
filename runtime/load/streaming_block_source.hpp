// SPDX-License-Identifier: MIT
// The records of a hierarchical compliance, fetched from the file as they are asked for.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/read/asset_reader.hpp"
#include "runtime/compliance/block_source.hpp"

namespace souple {

/// An open asset that several sources read from, one at a time.
struct SharedAssetReader {
  explicit SharedAssetReader(AssetReader opened) : reader(std::move(opened)) {}
  std::mutex mutex;
  AssetReader reader;
};

/// Fetches records on a thread of its own, chunk by chunk of the file, each chunk once. ready(),
/// block() and request() are for any thread, a real-time one too: they take no lock and read no file.
/// Memory is reserved for all records, but touched only where they were fetched; nothing is let go
/// before the end.
class StreamingBlockSource final : public BlockSource {
 public:
  /// Called by the fetching thread, once: what kept it from going on. Blocks that are not there yet
  /// never will be.
  using Failed = std::function<void(const Issue&)>;

  /// Records of a hierarchical variant whose index was read from the same asset; `failed` may be empty.
  /// Issues: those of AssetReader::read_compliance_cost; asset_corrupt; io_out_of_memory.
  static Result<std::unique_ptr<StreamingBlockSource>> create(std::shared_ptr<SharedAssetReader> asset,
                                                              const std::string& variant,
                                                              const HierarchicalIndex& index,
                                                              Failed failed = {});
  StreamingBlockSource(const StreamingBlockSource&) = delete;
  StreamingBlockSource& operator=(const StreamingBlockSource&) = delete;
  ~StreamingBlockSource() override;  ///< waits for a read that is under way

  bool ready(std::size_t leaf) const override;
  std::span<const std::byte> block(std::size_t leaf) const override;
  void request(std::size_t leaf) override;
  void request(std::span<const Index> leaves);
  /// Waits until every block that was asked for is there; false if fetching failed. Not for a real-time
  /// thread.
  bool wait_for_requested() const;
  /// Bytes of the chunks that were fetched so far, and of the bookkeeping.
  std::size_t resident_bytes() const override;

 private:
  enum class Leaf : std::uint8_t { absent, asked_for, ready };
  struct ChunkRange {
    std::size_t begin = 0, end = 0;
  };

  StreamingBlockSource(std::shared_ptr<SharedAssetReader> asset, std::string variant,
                       std::vector<std::int64_t> begins, std::size_t chunk_bytes, Failed failed);
  void run();
  std::vector<std::size_t> leaves_asked_for() const;
  ChunkRange chunks_of(std::size_t leaf) const;
  bool fetch(std::size_t leaf);
  Status read_chunks(ChunkRange chunks);
  void announce();

  const std::shared_ptr<SharedAssetReader> asset_;
  const std::string variant_;
  const std::vector<std::int64_t> begins_;
  const std::size_t chunk_bytes_;
  const Failed failed_;
  std::unique_ptr<std::byte[]> payload_;
  std::vector<char> has_chunk_;  ///< of the fetching thread
  std::vector<std::atomic<Leaf>> leaves_;
  std::atomic<std::size_t> fetched_bytes_{0};
  std::atomic<std::int32_t> request_count_{0};  ///< wakes the fetching thread; wraps around
  std::atomic<std::int32_t> answer_count_{0};   ///< wakes those who wait for blocks
  std::atomic<bool> stop_{false};
  std::atomic<bool> has_failed_{false};
  std::thread thread_;
};

}  // namespace souple
