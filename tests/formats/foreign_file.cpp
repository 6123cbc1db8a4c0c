// SPDX-License-Identifier: MIT
#include "foreign_file.hpp"

#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"

namespace souple::test {

void ForeignFile::SetUp() { ASSERT_TRUE(write_asset(asset_, file_).ok()); }

void ForeignFile::change(const std::function<void(hid_t)>& edit) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDWR, access);
  ASSERT_GE(file, 0);
  edit(file);
  ASSERT_GE(H5Fclose(file), 0);
  H5Pclose(access);
}

int ForeignFile::code() const {
  const ValidationReport report = validate_asset_file(file_);
  return report.issues.empty() ? 0 : number(report.issues.front().code);
}

void set_integer(hid_t file, const char* group, const char* name, std::int64_t value) {
  // Replaced: HDF5 1.10 does not find some attributes again to write into them.
  const hid_t object = H5Gopen2(file, group, H5P_DEFAULT);
  ASSERT_GE(H5Adelete(object, name), 0);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_INT64, &value), 0);
  H5Aclose(attribute), H5Sclose(space), H5Gclose(object);
}

void set_text(hid_t file, const char* group, const char* name, const std::string& value) {
  const hid_t object = H5Gopen2(file, group, H5P_DEFAULT);
  ASSERT_GE(H5Adelete(object, name), 0);
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, value.size());
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, type, value.data()), 0);
  H5Aclose(attribute), H5Sclose(space), H5Tclose(type), H5Gclose(object);
}

void set_scalar(hid_t file, const char* path, std::size_t scalar, double value) {
  const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  ASSERT_LT(scalar, values.size());
  ASSERT_GE(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  values[scalar] = value;
  ASSERT_GE(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  H5Sclose(space), H5Dclose(dataset);
}

hid_t replace_dataset(hid_t file, const char* path, const DatasetShape& shape) {
  if (H5Lexists(file, path, H5P_DEFAULT) > 0) H5Ldelete(file, path, H5P_DEFAULT);
  const int rank = static_cast<int>(shape.extent.size());
  const std::vector<hsize_t> unlimited(shape.extent.size(), H5S_UNLIMITED);
  const hid_t space =
      H5Screate_simple(rank, shape.extent.data(), shape.growing ? unlimited.data() : nullptr);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  if (!shape.chunk.empty()) H5Pset_chunk(creation, rank, shape.chunk.data());
  for (const H5Z_filter_t filter : shape.filters) {
    const unsigned level = 3;
    if (filter == H5Z_FILTER_SHUFFLE)
      H5Pset_shuffle(creation);
    else if (filter == H5Z_FILTER_FLETCHER32)
      H5Pset_fletcher32(creation);
    else
      H5Pset_filter(creation, filter, H5Z_FLAG_MANDATORY, 1, &level);
  }
  const hid_t dataset = H5Dcreate2(file, path, shape.type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  EXPECT_GE(dataset, 0);
  H5Pclose(creation), H5Sclose(space);
  return dataset;
}

}  // namespace souple::test
