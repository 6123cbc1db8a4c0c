// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged tet files, handed to the readers directly: no child process hides a crash, a hang or an
// appetite for memory. Deterministic; SOUPLE_FUZZ_ROUNDS asks for more rounds a file, SOUPLE_FUZZ_SEED
// for others.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/tools/exchange/tet_data.hpp"
#include "tools/exchange/mesh_writer.hpp"
#include "tools/exchange/tets/mesh_transfer.hpp"
#include "tools/exchange/tets/sort_out_tets.hpp"
#include "tools/exchange/tets/tet_format.hpp"
#include "tools/exchange/tets/tet_readers.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

unsigned from_environment(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

/// One to four edits of sound bytes, where it hurts: at numbers, counts and keywords.
class Mutator {
 public:
  Mutator(std::string sound, unsigned seed) : sound_(std::move(sound)), random_(seed) {}

  std::string next() {
    std::string bytes = sound_;
    for (unsigned edits = 1 + random_() % 4; edits > 0 && !bytes.empty(); --edits) edit(bytes);
    return bytes;
  }

 private:
  /// Half of the edits fall into the first kilobyte, where the headers are.
  std::size_t place(const std::string& bytes) {
    const std::size_t range =
        random_() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 1024) : bytes.size();
    return random_() % range;
  }

  void edit(std::string& bytes) {
    static constexpr std::array<std::string_view, 16> words{
        "99999999999",         "-1", "0", "nan", "inf", "1e999", "2147483647", "4294967296",
        "9223372036854775807", "",   "$", "<",   "#",   "1.5",   "-0",         "10"};
    const std::size_t at = place(bytes);
    switch (random_() % 7) {
      case 0:
        return bytes.resize(at);
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random_() % 8));
        return;
      case 2:
        bytes[at] = static_cast<char>(random_());
        return;
      case 3:
        return replace_word(bytes, at, words[random_() % words.size()]);
      case 4:
        return overwrite(bytes, at);
      case 5: {  // a line, or a piece of one, once more
        const std::size_t size = std::min<std::size_t>(bytes.size() - at, random_() % 200);
        bytes.insert(place(bytes), bytes.substr(at, size));
        return;
      }
      default:
        bytes.erase(at, random_() % 60);
    }
  }

  static void replace_word(std::string& bytes, std::size_t at, std::string_view word) {
    const std::size_t begin = bytes.find_last_of(" \t\r\n\"<>", at) + 1;  // npos + 1 is 0
    const std::size_t end = std::min(bytes.find_first_of(" \t\r\n\"<>", begin), bytes.size());
    bytes.replace(begin, end - begin, word);
  }

  /// Binary counts and indices.
  void overwrite(std::string& bytes, std::size_t at) {
    static constexpr std::array<std::uint64_t, 7> values{
        0, 1, 0xFF, 0x7FFFFFFF, 0xFFFFFFFF, std::uint64_t{1} << 40, ~std::uint64_t{0}};
    const std::uint64_t value = values[random_() % values.size()];
    const std::size_t width = std::min<std::size_t>(bytes.size() - at, std::size_t{1} << random_() % 4);
    for (std::size_t k = 0; k < width; ++k) bytes[at + k] = static_cast<char>(value >> (8 * k));
  }

  std::string sound_;
  std::mt19937 random_;
};

struct Sample {
  std::string name, bytes, partner;
};

Result<RawMesh> read(const Sample& sample, const std::string& bytes) {
  const std::string extension = fs::path(sample.name).extension().string();
  if (extension == ".node") return read_tetgen(bytes, sample.partner);
  if (extension == ".ele") return read_tetgen(sample.partner, bytes);
  if (extension == ".veg") return read_vega(bytes);
  if (extension == ".mesh") return read_medit(bytes);
  if (extension == ".vtk") return read_vtk(bytes);
  return extension == ".vtu" ? read_vtu(bytes) : read_gmsh(bytes);
}

/// Everything that is done with a file of unknown origin; false if a promise was broken.
bool use(const Sample& sample, const std::string& bytes) {
  static_cast<void>(recognise_tet_format(bytes, fs::path(sample.name).extension().string()).ok());
  Result<RawMesh> mesh = read(sample, bytes);
  if (!mesh) {
    const IssueCode code = mesh.issue().code;
    return code == IssueCode::tet_file_malformed || code == IssueCode::tet_file_unsupported;
  }
  // The parent process checks again: what the reader passes must be sound.
  if (!unpack_raw_mesh(pack_raw_mesh(*mesh))) return false;
  const bool is_moderate = std::ranges::all_of(mesh->nodes, [](const Point& p) {
    return std::abs(p[0]) < 1e15 && std::abs(p[1]) < 1e15 && std::abs(p[2]) < 1e15;
  });
  if (is_moderate && mesh->tets.size() < 1000)
    static_cast<void>(sort_out_tets(mesh->nodes, mesh->tets, mesh->labels, true).ok());
  return true;
}

std::vector<Sample> real_samples() {
  std::vector<Sample> samples;
  for (const auto& entry : fs::directory_iterator(real_tet_dir())) {
    Sample sample{entry.path().filename().string(), file_content(entry.path()), {}};
    fs::path partner = entry.path();
    if (partner.extension() == ".node")
      sample.partner = file_content(partner.replace_extension(".ele"));
    if (partner.extension() == ".ele")
      sample.partner = file_content(partner.replace_extension(".node"));
    samples.push_back(std::move(sample));
  }
  std::ranges::sort(samples, {}, &Sample::name);
  return samples;
}

/// What souple itself writes: small, with labels, in every format.
std::vector<Sample> written_samples() {
  TemporaryFolder folder;
  const TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.5}},
                     {{0, 1, 2, 3}, {1, 4, 2, 3}}};
  std::vector<Sample> samples;
  for (const std::string name : {"a.msh", "a.mesh", "a.vtu", "a.vtk", "a.node"}) {
    EXPECT_TRUE(write_tets(mesh, {0, 1}, folder / name).ok());
    samples.push_back({name, file_content(folder / name), {}});
  }
  samples.push_back({"a.ele", file_content(folder / "a.ele"), samples.back().bytes});
  samples[4].partner = samples[5].bytes;
  return samples;
}

/// A crash must not hide which file it was: each is mutated in a child of its own.
void expect_sound(const Sample& sample, const std::function<bool()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(120);
    ::_exit(work() ? 0 : 1);
  }
  int status = -1;
  rusage usage{};
  ASSERT_EQ(::wait4(child, &status, 0, &usage), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
      << sample.name << ": status " << WEXITSTATUS(status) << ", signal " << WTERMSIG(status);
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(usage.ru_maxrss, 256 << 10) << "KiB, " << sample.name;
#endif
}

void mutate_all(const std::vector<Sample>& samples, unsigned rounds) {
  const unsigned seed = from_environment("SOUPLE_FUZZ_SEED", 1);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const Sample& sample = samples[s];
    EXPECT_TRUE(use(sample, sample.bytes)) << sample.name;
    expect_sound(sample, [&] {
      Mutator mutator(sample.bytes, seed * 1000 + static_cast<unsigned>(s));
      for (unsigned i = 0; i < rounds; ++i)
        if (!use(sample, mutator.next())) return false;
      return true;
    });
  }
}

TEST(TetFileMutations, OfRealFilesNeverCrashHangOrExhaustMemory) {
  SOUPLE_NEEDS_REAL_TETS();
  mutate_all(real_samples(), from_environment("SOUPLE_FUZZ_ROUNDS", 500));
}

TEST(TetFileMutations, OfWrittenFilesNeverCrashHangOrExhaustMemory) {
  mutate_all(written_samples(), from_environment("SOUPLE_FUZZ_ROUNDS", 4000));
}

TEST(TetFileMutations, EveryTruncationOfWrittenFilesIsJudged) {
  for (const Sample& sample : written_samples())
    expect_sound(sample, [&] {
      for (std::size_t size = 0; size < sample.bytes.size(); ++size)
        if (!use(sample, sample.bytes.substr(0, size))) return false;
      return true;
    });
}

}  // namespace
}  // namespace souple
