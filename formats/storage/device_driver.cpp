// SPDX-License-Identifier: MIT
#include "formats/storage/device_driver.hpp"

#include <limits>
#include <new>

namespace souple::storage {
namespace {

struct DriverInfo {
  ByteDevice* device;
};

/// HDF5 fills `base` and hands the pointer back: it must be the first member.
struct DeviceFile {
  H5FD_t base;
  ByteDevice* device;
  haddr_t end_of_allocation;
};

DeviceFile& device_file(H5FD_t* file) { return *reinterpret_cast<DeviceFile*>(file); }
const DeviceFile& device_file(const H5FD_t* file) { return *reinterpret_cast<const DeviceFile*>(file); }

H5FD_t* open_file(const char*, unsigned, hid_t access, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  auto* file = new (std::nothrow) DeviceFile{H5FD_t{}, info->device, 0};
  return file == nullptr ? nullptr : &file->base;
}

herr_t close_file(H5FD_t* file) {
  delete &device_file(file);
  return 0;
}

herr_t query_features(const H5FD_t*, unsigned long* features) {
  *features = 0;
  return 0;
}

haddr_t get_end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return device_file(file).end_of_allocation;
}

herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  device_file(file).end_of_allocation = address;
  return 0;
}

haddr_t get_end_of_file(const H5FD_t* file, H5FD_mem_t) { return device_file(file).device->size(); }

herr_t read_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* buffer) {
  return device_file(file).device->read(address, {static_cast<std::byte*>(buffer), size}) ? 0 : -1;
}

herr_t write_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, const void* buffer) {
  return device_file(file).device->write(address, {static_cast<const std::byte*>(buffer), size}) ? 0
                                                                                                 : -1;
}

herr_t truncate_file(H5FD_t* file, hid_t, hbool_t) {
  DeviceFile& opened = device_file(file);
  if (opened.device->size() == opened.end_of_allocation) return 0;
  return opened.device->resize(opened.end_of_allocation) ? 0 : -1;
}

const H5FD_class_t driver_class = [] {
  H5FD_class_t driver{};
  driver.name = "souple_device";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<std::int64_t>::max());
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query_features;
  driver.get_eoa = get_end_of_allocation;
  driver.set_eoa = set_end_of_allocation;
  driver.get_eof = get_end_of_file;
  driver.read = read_bytes;
  driver.write = write_bytes;
  driver.truncate = truncate_file;
  for (H5FD_mem_t& type : driver.fl_map) type = H5FD_MEM_SUPER;
  return driver;
}();

/// Access properties that send HDF5 to `device`.
Handle access_properties(ByteDevice& device) {
  Handle driver(H5FDregister(&driver_class));
  Handle access(H5Pcreate(H5P_FILE_ACCESS));
  const DriverInfo info{&device};
  const bool ok = driver && access && H5Pset_driver(access.get(), driver.get(), &info) >= 0 &&
                  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG) >= 0 &&
                  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0;
  return ok ? std::move(access) : Handle();
}

}  // namespace

void set_plain_object(hid_t properties) {
  H5Pset_obj_track_times(properties, false);
  // Attributes never move to a fractal heap: a header is one checksummed run of bytes.
  H5Pset_attr_phase_change(properties, 4096, 0);
}

void set_plain_group(hid_t properties) {
  set_plain_object(properties);
  H5Pset_link_phase_change(properties, 4096, 0);
}

Handle open_device(ByteDevice& device) {
  const Handle access = access_properties(device);
  return Handle(access ? H5Fopen("asset", H5F_ACC_RDONLY, access.get()) : H5I_INVALID_HID);
}

Handle create_device(ByteDevice& device) {
  const Handle access = access_properties(device);
  const Handle creation(H5Pcreate(H5P_FILE_CREATE));
  if (!access || !creation) return Handle();
  set_plain_group(creation.get());
  return Handle(H5Fcreate("asset", H5F_ACC_TRUNC, creation.get(), access.get()));
}

}  // namespace souple::storage
