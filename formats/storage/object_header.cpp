// SPDX-License-Identifier: MIT
// "HDF5 File Format Specification Version 3.0", IV.A.1.b: object headers of version 2.
#include "formats/storage/object_header.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "formats/storage/byte_cursor.hpp"
#include "formats/storage/fixed_array.hpp"
#include "formats/storage/header_messages.hpp"
#include "formats/storage/metadata_block.hpp"

namespace souple::storage {
namespace {

constexpr std::size_t most_blocks = 1024;  // of one header: a ring of continuations ends here

constexpr std::uint64_t bit(Message message) {
  return std::uint64_t{1} << static_cast<unsigned>(message);
}
/// Those that may stand more than once.
constexpr std::uint64_t repeated_messages =
    bit(Message::null) | bit(Message::link) | bit(Message::attribute) | bit(Message::continuation);
constexpr std::uint64_t common_messages = bit(Message::null) | bit(Message::attribute) |
                                          bit(Message::continuation) | bit(Message::attribute_info);
constexpr std::uint64_t dataset_needs = bit(Message::dataspace) | bit(Message::datatype) |
                                        bit(Message::layout) | bit(Message::filters) |
                                        bit(Message::fill_value);
constexpr std::uint64_t group_needs = bit(Message::link_info) | bit(Message::group_info);

constexpr std::uint64_t needs_of(ObjectKind kind) {
  return kind == ObjectKind::group ? group_needs : dataset_needs;
}
constexpr std::uint64_t allowed_in(ObjectKind kind) {
  return common_messages | needs_of(kind) | (kind == ObjectKind::group ? bit(Message::link) : 0);
}

class HeaderWalk {
 public:
  HeaderWalk(ByteDevice& device, ObjectKind kind) : device_(device), kind_(kind) {}

  bool run(std::uint64_t address) {
    if (!take_first_block(address)) return false;
    // `next_` grows while continuations are found.
    for (std::size_t i = 0; i < next_.size(); ++i)
      if (next_.size() > most_blocks || !take_continuation(next_[i])) return false;
    const std::uint64_t needs = needs_of(kind_);
    return (seen_ & needs) == needs && (kind_ == ObjectKind::group || fits_together());
  }

 private:
  struct Extent {
    std::uint64_t address, length;
  };

  bool take_first_block(std::uint64_t address) {
    // Signature, version, flags, four times, attribute limits, size of the messages: at most this long.
    constexpr std::uint64_t longest_front = 34;
    if (address >= device_.size()) return false;
    std::vector<std::byte> front(std::min(longest_front, device_.size() - address));
    if (!device_.read(address, front)) return false;
    ByteCursor cursor(front);
    if (!cursor.signature("OHDR") || !cursor.is(1, 2)) return false;
    const std::uint64_t flags = cursor.number(1);
    const bool has_times = (flags & 0x20) != 0, has_attribute_limits = (flags & 0x10) != 0;
    cursor.take((has_times ? 16 : 0) + (has_attribute_limits ? 4 : 0));
    const std::uint64_t message_bytes = cursor.number(std::size_t{1} << (flags & 3));
    if (!cursor.ok() || (flags & 0xC0) != 0 || message_bytes > largest_metadata_block) return false;
    has_order_ = (flags & 0x04) != 0;
    const std::size_t front_bytes = front.size() - cursor.left();
    const auto block =
        read_metadata_block(device_, address, front_bytes + message_bytes + checksum_bytes);
    return !block.empty() && take_messages(std::span(block).subspan(front_bytes));
  }

  bool take_continuation(const Extent& extent) {
    const auto block = read_metadata_block(device_, extent.address, extent.length);
    return ByteCursor(block).signature("OCHK") && take_messages(std::span(block).subspan(4));
  }

  bool take_messages(std::span<const std::byte> bytes) {
    const std::size_t prefix = has_order_ ? 6 : 4;
    ByteCursor cursor(bytes);
    while (cursor.left() >= prefix) {  // less than a prefix is a gap
      const std::uint64_t number = cursor.number(1), size = cursor.number(2), flags = cursor.number(1);
      cursor.take(prefix - 4);
      const auto body = cursor.take(size);
      // Of the flags only "constant" (1) and "do not share" (4) leave the message what it is.
      if (!cursor.ok() || number > 63 || (flags & ~std::uint64_t{5}) != 0) return false;
      const auto type = static_cast<Message>(number);
      if ((allowed_in(kind_) & bit(type)) == 0 || (seen_ & ~repeated_messages & bit(type)) != 0)
        return false;
      seen_ |= bit(type);
      if (!take_message(type, body)) return false;
    }
    return true;
  }

  bool take_message(Message type, std::span<const std::byte> body) {
    switch (type) {
      case Message::dataspace:
        return (space_ = parse_dataspace(body)).has_value();
      case Message::datatype:
        return (scalar_bytes_ = parse_datatype(body)).has_value();
      case Message::layout:
        return (layout_ = parse_layout(body)).has_value();
      case Message::continuation: {
        ByteCursor cursor(body);
        const std::uint64_t address = cursor.number(8), length = cursor.number(8);
        next_.push_back({address, length});
        return cursor.at_end();
      }
      default:
        return is_sound_message(type, body);
    }
  }

  /// Extent, scalar and chunks of a dataset agree.
  bool fits_together() {
    if (space_->rank != layout_->rank || *scalar_bytes_ != layout_->scalar_bytes) return false;
    if (layout_->has_array) return is_sound_fixed_array(device_, *layout_, *space_);
    return std::equal(space_->extent.begin(), space_->extent.end(), layout_->chunk.begin());
  }

  ByteDevice& device_;
  ObjectKind kind_;
  std::uint64_t seen_ = 0;
  bool has_order_ = false;
  std::vector<Extent> next_;
  std::optional<Dataspace> space_;
  std::optional<std::uint64_t> scalar_bytes_;
  std::optional<ChunkLayout> layout_;
};

}  // namespace

bool is_sound_object(ByteDevice& device, std::uint64_t address, ObjectKind kind) {
  return HeaderWalk(device, kind).run(address);
}

}  // namespace souple::storage
