// SPDX-License-Identifier: GPL-3.0-or-later
// Real tet files for the tests of the exchange.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "formats/core/mesh.hpp"

namespace souple {

inline std::filesystem::path real_tet_dir() {
  const char* dir = std::getenv("SOUPLE_DATA_DIR");
  return std::filesystem::path(dir != nullptr ? dir : SOUPLE_DEFAULT_DATA_DIR) / "tets";
}

/// Left out on a machine without the data; an error in CI.
#define SOUPLE_NEEDS_REAL_TETS()                                                 \
  if (!std::filesystem::is_directory(real_tet_dir())) {                          \
    if (std::getenv("CI") != nullptr) FAIL() << "no data at " << real_tet_dir(); \
    GTEST_SKIP() << "no data at " << real_tet_dir() << "; set SOUPLE_DATA_DIR";  \
  }                                                                              \
  static_assert(true)

inline std::string file_content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline double volume_of(const TetMesh& mesh) {
  double six = 0;
  for (const Tet& t : mesh.tets) {
    const auto corner = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(t[k])]; };
    six += signed_volume6(corner(0), corner(1), corner(2), corner(3));
  }
  return six / 6;
}

/// A folder that is removed with its content.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "souple_tets_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace souple
