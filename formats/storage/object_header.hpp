// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "formats/storage/byte_device.hpp"

namespace souple::storage {

enum class ObjectKind : std::uint8_t { group, dataset };

/// Looks at an object before HDF5 does: an object header of version 2 whose checksums fit, every block
/// of it inside the file, with no messages but those that our writer and its successors need, and for a
/// dataset a chunk index of the kinds and checksums of version 4. HDF5 1.10 leaks and, in its older
/// structures without checksums, may crash on damaged bytes; what passes here it can parse.
bool is_sound_object(ByteDevice& device, std::uint64_t address, ObjectKind kind);

}  // namespace souple::storage
