// SPDX-License-Identifier: MIT
#include "runtime/load/streaming_block_source.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace souple {

StreamingBlockSource::StreamingBlockSource(std::shared_ptr<SharedAssetReader> asset,
                                           std::string variant, std::vector<std::int64_t> begins,
                                           std::size_t chunk_bytes, Failed failed)
    : asset_(std::move(asset)),
      variant_(std::move(variant)),
      begins_(std::move(begins)),
      chunk_bytes_(chunk_bytes),
      failed_(std::move(failed)),
      // Not initialised: pages that no record is put into take no memory.
      payload_(new std::byte[static_cast<std::size_t>(begins_.back())]),
      has_chunk_((static_cast<std::size_t>(begins_.back()) + chunk_bytes - 1) / chunk_bytes),
      leaves_(begins_.size() - 1) {
  thread_ = std::thread([this] { run(); });
}

Result<std::unique_ptr<StreamingBlockSource>> StreamingBlockSource::create(
    std::shared_ptr<SharedAssetReader> asset, const std::string& variant,
    const HierarchicalIndex& index, Failed failed) {
  try {
    const std::lock_guard lock(asset->mutex);
    const Result<GroupCost> cost = asset->reader.read_compliance_cost(variant);
    if (!cost) return cost.issue();
    const bool fits = index.record_begin.size() >= 2 && std::ranges::is_sorted(index.record_begin) &&
                      index.record_begin.front() == 0 &&
                      index.record_begin.back() == static_cast<std::int64_t>(cost->payload_raw_bytes);
    if (!fits)
      return make_issue(IssueCode::asset_corrupt, "the index does not belong to the payload",
                        "compliance/" + variant);
    return std::unique_ptr<StreamingBlockSource>(new StreamingBlockSource(
        asset, variant, index.record_begin, static_cast<std::size_t>(cost->payload_chunk_bytes),
        std::move(failed)));
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
}

StreamingBlockSource::~StreamingBlockSource() {
  stop_.store(true, std::memory_order_relaxed);
  request_count_.fetch_add(1, std::memory_order_release);
  request_count_.notify_all();
  thread_.join();
}

bool StreamingBlockSource::ready(std::size_t leaf) const {
  // Acquire: what the fetching thread wrote into the payload is seen by who sees the leaf ready.
  return leaf < leaves_.size() && leaves_[leaf].load(std::memory_order_acquire) == Leaf::ready;
}

std::span<const std::byte> StreamingBlockSource::block(std::size_t leaf) const {
  const auto begin = static_cast<std::size_t>(begins_[leaf]);
  return {payload_.get() + begin, static_cast<std::size_t>(begins_[leaf + 1]) - begin};
}

void StreamingBlockSource::request(std::size_t leaf) {
  if (leaf >= leaves_.size()) return;
  Leaf expected = Leaf::absent;
  if (!leaves_[leaf].compare_exchange_strong(expected, Leaf::asked_for, std::memory_order_relaxed))
    return;
  request_count_.fetch_add(1, std::memory_order_release);
  request_count_.notify_one();
}

void StreamingBlockSource::request(std::span<const Index> leaves) {
  for (const Index leaf : leaves)
    if (leaf >= 0) request(static_cast<std::size_t>(leaf));
}

bool StreamingBlockSource::wait_for_requested() const {
  const auto is_asked_for = [](const std::atomic<Leaf>& leaf) {
    return leaf.load(std::memory_order_acquire) == Leaf::asked_for;
  };
  for (;;) {
    const std::int32_t seen = answer_count_.load(std::memory_order_acquire);
    if (std::ranges::none_of(leaves_, is_asked_for)) return true;
    if (has_failed_.load(std::memory_order_acquire)) return false;
    answer_count_.wait(seen, std::memory_order_acquire);
  }
}

std::size_t StreamingBlockSource::resident_bytes() const {
  return fetched_bytes_.load(std::memory_order_relaxed) + begins_.size() * sizeof(std::int64_t) +
         leaves_.size() + has_chunk_.size();
}

void StreamingBlockSource::run() {
  for (;;) {
    const std::int32_t seen = request_count_.load(std::memory_order_acquire);
    bool fetched_any = false;
    for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
      if (stop_.load(std::memory_order_relaxed)) return;
      if (leaves_[leaf].load(std::memory_order_relaxed) != Leaf::asked_for) continue;
      if (!fetch(leaf)) return;
      fetched_any = true;
    }
    if (!fetched_any) request_count_.wait(seen, std::memory_order_acquire);
  }
}

StreamingBlockSource::ChunkRange StreamingBlockSource::chunks_of(std::size_t leaf) const {
  return {static_cast<std::size_t>(begins_[leaf]) / chunk_bytes_,
          (static_cast<std::size_t>(begins_[leaf + 1]) + chunk_bytes_ - 1) / chunk_bytes_};
}

/// Reads the chunks of the leaf that are not there yet, runs of them at once; false if that failed.
bool StreamingBlockSource::fetch(std::size_t leaf) {
  const ChunkRange all = chunks_of(leaf);
  for (ChunkRange run{all.begin, all.begin}; run.end < all.end; run.begin = run.end) {
    while (run.begin < all.end && has_chunk_[run.begin]) ++run.begin;
    run.end = run.begin;
    while (run.end < all.end && !has_chunk_[run.end]) ++run.end;
    if (run.begin == run.end) break;
    if (const Status status = read_chunks(run); !status) {
      has_failed_.store(true, std::memory_order_release);
      announce();
      if (failed_) failed_(status.issue());
      return false;
    }
  }
  leaves_[leaf].store(Leaf::ready, std::memory_order_release);
  announce();
  return true;
}

Status StreamingBlockSource::read_chunks(ChunkRange chunks) {
  const std::size_t begin = chunks.begin * chunk_bytes_;
  const std::size_t end = std::min(chunks.end * chunk_bytes_, static_cast<std::size_t>(begins_.back()));
  const std::lock_guard lock(asset_->mutex);
  Status status =
      asset_->reader.read_payload(variant_, begin, std::span(payload_.get() + begin, end - begin));
  if (!status) return status;
  std::fill(has_chunk_.begin() + static_cast<std::ptrdiff_t>(chunks.begin),
            has_chunk_.begin() + static_cast<std::ptrdiff_t>(chunks.end), char{1});
  fetched_bytes_.fetch_add(end - begin, std::memory_order_relaxed);
  return status;
}

void StreamingBlockSource::announce() {
  answer_count_.fetch_add(1, std::memory_order_release);
  answer_count_.notify_all();
}

}  // namespace souple
