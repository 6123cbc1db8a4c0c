// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/fclib/fclib_problem.hpp"

namespace souple {

/// Reads a problem in FCLIB's layout in a process of its own: HDF5 may crash on damaged files of the
/// old, checksum-less kind that FCLIB's are. What comes back is checked again. Issues: those of
/// read_fclib, io_file_too_large, io_child_not_started.
Result<FclibProblem> read_contact_problem(const std::string& file);

}  // namespace souple
