// SPDX-License-Identifier: MIT
#pragma once
#include "formats/storage/byte_device.hpp"
#include "formats/storage/header_messages.hpp"

namespace souple::storage {

/// The chunk index of a filtered dataset: header, data block and pages are there, their checksums fit,
/// and the counts are those that follow from extent and chunk.
bool is_sound_fixed_array(ByteDevice& device, const ChunkLayout& layout, const Dataspace& space);

}  // namespace souple::storage
