// SPDX-License-Identifier: MIT
// Entry points by which HDF5 finds the filter in a folder of HDF5_PLUGIN_PATH.
#include <H5PLextern.h>

#include "formats/filter/zstd_filter.hpp"

extern "C" {

H5PL_type_t H5PLget_plugin_type(void) { return H5PL_TYPE_FILTER; }
const void* H5PLget_plugin_info(void) { return &souple::storage::zstd_filter_class(); }
}
