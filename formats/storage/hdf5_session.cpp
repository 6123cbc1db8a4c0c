// SPDX-License-Identifier: MIT
#include "formats/storage/hdf5_session.hpp"

#include "formats/filter/zstd_filter.hpp"

namespace souple::storage {
namespace {

std::mutex& process_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Hdf5Session::Hdf5Session() : lock_(process_mutex()) {
  H5open();
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5Zregister(&zstd_filter_class());
}

Hdf5Session::~Hdf5Session() {
  H5Eclear2(H5E_DEFAULT);
  H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
}

}  // namespace souple::storage
