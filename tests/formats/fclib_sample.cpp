// SPDX-License-Identifier: MIT
#include "fclib_sample.hpp"

#include "formats/storage/hdf5_session.hpp"

namespace souple::test {
namespace {

using storage::Handle;

void write(hid_t file, const std::string& path, hid_t type, hsize_t count, const void* values) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE)), space(H5Screate_simple(1, &count, nullptr));
  H5Pset_create_intermediate_group(links.get(), 1);
  const Handle set(
      H5Dcreate2(file, path.c_str(), type, space.get(), links.get(), H5P_DEFAULT, H5P_DEFAULT));
  if (count > 0) H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
}

void write_text(hid_t file, const std::string& path, const std::string& text) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE)), space(H5Screate(H5S_SCALAR)), type(H5Tcopy(H5T_C_S1));
  H5Pset_create_intermediate_group(links.get(), 1);
  H5Tset_size(type.get(), text.size() + 1);
  const Handle set(
      H5Dcreate2(file, path.c_str(), type.get(), space.get(), links.get(), H5P_DEFAULT, H5P_DEFAULT));
  H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str());
}

}  // namespace

std::vector<std::byte> RawFclib::bytes() const {
  const storage::Hdf5Session session;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fapl_core(access.get(), 1 << 16, 0);
  const Handle file(H5Fcreate("sample", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()));
  for (const auto& [path, values] : integers)
    write(file.get(), path, H5T_NATIVE_INT, values.size(), values.data());
  for (const auto& [path, values] : reals)
    write(file.get(), path, H5T_NATIVE_DOUBLE, values.size(), values.data());
  for (const auto& [path, text] : texts) write_text(file.get(), path, text);
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  std::vector<std::byte> image(static_cast<std::size_t>(H5Fget_file_image(file.get(), nullptr, 0)));
  H5Fget_file_image(file.get(), image.data(), image.size());
  return image;
}

RawFclib sample_fclib() {
  RawFclib raw;
  const std::string w = "fclib_local/W/";
  std::vector<int> row, column;
  std::vector<double> value;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      if (i != j && i % 3 != j % 3) continue;
      row.push_back(i);
      column.push_back(j);
      value.push_back(i == j ? 2 : 0.5 + 0.25 * i);  // unsymmetric
    }
  const int count = static_cast<int>(row.size());
  raw.integers = {
      {"fclib_local/spacedim", {3}}, {w + "nzmax", {count}}, {w + "m", {6}},   {w + "n", {6}},
      {w + "nz", {count}},           {w + "p", row},         {w + "i", column}};
  raw.reals = {{w + "x", value},
               {"fclib_local/vectors/q", {-4, 3, 0, -1, 0.5, 1}},
               {"fclib_local/vectors/mu", {0.5, 0.3}}};
  raw.texts = {{"fclib_local/info/title", "two contacts"},
               {"fclib_local/info/description", "of the tests"},
               {"fclib_local/info/math_info", "unsymmetric"}};
  return raw;
}

}  // namespace souple::test
