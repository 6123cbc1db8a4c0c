// SPDX-License-Identifier: MIT
// A virtual file driver of HDF5 that works on a ByteDevice: the same code opens files and memory, and
// every byte fetched is counted.
#pragma once
#include "formats/storage/byte_device.hpp"
#include "formats/storage/hdf5_session.hpp"

namespace souple::storage {

/// Opens read-only what check_superblock accepted; an empty handle if HDF5 refuses. `device` must
/// outlive the handle.
Handle open_device(ByteDevice& device);

/// A new file in format V110 (checksummed metadata), without object times; groups and attributes stay
/// in object headers.
Handle create_device(ByteDevice& device);

/// Creation properties of a group, or of the root group through `file_create`: see create_device.
void set_plain_object(hid_t properties);
void set_plain_group(hid_t properties);

}  // namespace souple::storage
