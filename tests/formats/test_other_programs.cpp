// SPDX-License-Identifier: MIT
// h5dump, h5ls and h5py open assets with the plugin.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "formats/write/asset_writer.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

struct Output {
  int exit_code = -1;
  std::string text;
};

Output run(const std::string& command) {
  Output output;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.text.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) output.exit_code = WEXITSTATUS(status);
  return output;
}

const std::string with_plugin = "HDF5_PLUGIN_PATH='" SOUPLE_PLUGIN_DIR "' ";

class OtherPrograms : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_asset(asset_, file_).ok()); }
  ScratchFolder scratch_;
  std::string file_ = scratch_.path("a.souple");
  Asset asset_ = make_sample_asset();
};

TEST_F(OtherPrograms, H5dumpPrintsTheNumbers) {
  const Output tets = run(with_plugin + "h5dump -y -w 1 -d /mesh/levels/0/tets '" + file_ + "'");
  ASSERT_EQ(tets.exit_code, 0) << "h5dump of the package hdf5-tools: " << tets.text;
  const std::size_t begin = tets.text.find("DATA {");
  ASSERT_NE(begin, std::string::npos) << tets.text;
  std::istringstream numbers(tets.text.substr(begin + 6));
  for (const Tet& tet : asset_.levels[0].mesh.tets)
    for (const Index expected : tet) {
      Index printed = -1;
      numbers >> printed;
      EXPECT_EQ(printed, expected);
      numbers.ignore(1);
    }
}

TEST_F(OtherPrograms, H5dumpPrintsEverything) {
  const Output all = run(with_plugin + "h5dump '" + file_ + "'");
  EXPECT_EQ(all.exit_code, 0) << all.text.substr(0, 2000);
  for (const char* expected :
       {"\"souple\"", "tets = 48", "flesh", "dense-tiled", "GROUP \"clamped-static\"", "hierarchical",
        "worst-column", "prolongation_weights", "record_begin"})
    EXPECT_NE(all.text.find(expected), std::string::npos) << expected;
}

TEST_F(OtherPrograms, H5dumpNeedsThePlugin) {
  const Output without =
      run("HDF5_PLUGIN_PATH=/nonexistent h5dump -d /mesh/levels/0/tets '" + file_ + "'");
  EXPECT_NE(without.text.find("unable to print data"), std::string::npos) << without.text;
}

TEST_F(OtherPrograms, H5lsListsTheGroups) {
  const Output listed = run("h5ls -r '" + file_ + "'");
  ASSERT_EQ(listed.exit_code, 0) << listed.text;
  EXPECT_NE(listed.text.find("/compliance/default/payload Dataset {10, 576}"), std::string::npos)
      << listed.text;
  const std::string records = "/compliance/compressed/payload Dataset {" +
                              std::to_string(asset_.compliances[3].payload.size()) + "}";
  EXPECT_NE(listed.text.find(records), std::string::npos) << listed.text;
}

TEST_F(OtherPrograms, H5pyReadsTheNumbers) {
  // Debian's own interpreter: another one in the path would not see Debian's h5py.
  if (run("/usr/bin/python3 -c 'import h5py'").exit_code != 0) GTEST_SKIP() << "no h5py";
  const Output sum = run(with_plugin + "/usr/bin/python3 -c \"import h5py; print(int(h5py.File('" +
                         file_ + "')['mesh/levels/1/tets'][:].sum()))\"");
  ASSERT_EQ(sum.exit_code, 0) << sum.text;
  long expected = 0;
  for (const Tet& tet : asset_.levels[1].mesh.tets)
    for (const Index node : tet) expected += node;
  EXPECT_EQ(std::stol(sum.text), expected);
}

}  // namespace
}  // namespace souple::test
