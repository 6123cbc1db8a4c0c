// SPDX-License-Identifier: GPL-3.0-or-later
// Real surface files for the tests of the tools.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"

namespace souple {

inline std::filesystem::path real_surface_dir() {
  const char* dir = std::getenv("SOUPLE_DATA_DIR");
  return std::filesystem::path(dir != nullptr ? dir : SOUPLE_DEFAULT_DATA_DIR) / "surfaces";
}

/// Left out on a machine without the data; an error in CI.
#define SOUPLE_NEEDS_REAL_SURFACES()                                                 \
  if (!std::filesystem::is_directory(real_surface_dir())) {                          \
    if (std::getenv("CI") != nullptr) FAIL() << "no data at " << real_surface_dir(); \
    GTEST_SKIP() << "no data at " << real_surface_dir() << "; set SOUPLE_DATA_DIR";  \
  }                                                                                  \
  static_assert(true)

/// Closed and outward, the longest side 0.2 m.
inline TriangleMesh closed_real_surface(const std::string& name, double size_m = 0.2) {
  ImportOptions options;
  options.size_m = size_m;
  auto imported = import_surface(real_surface_dir() / name, options);
  EXPECT_TRUE(imported.ok()) << name << ": " << format_issue(imported.issue());
  if (!imported) return {};
  auto oriented = orient_closed_surface(imported->mesh);
  EXPECT_TRUE(oriented.ok()) << name << ": " << format_issue(oriented.issue());
  return oriented ? std::move(oriented->mesh) : TriangleMesh{};
}

}  // namespace souple
