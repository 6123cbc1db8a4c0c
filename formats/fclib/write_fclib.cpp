// SPDX-License-Identifier: MIT
#include "formats/fclib/write_fclib.hpp"

#include <exception>
#include <limits>
#include <string>

#include "formats/fclib/names.hpp"
#include "formats/fclib/sparse_entries.hpp"
#include "formats/storage/byte_device.hpp"
#include "formats/storage/device_driver.hpp"
#include "formats/storage/hdf5_session.hpp"
#include "formats/write/replace_file.hpp"

namespace souple {
namespace {

using storage::Handle;

constexpr std::size_t longest_text = 65535;

// A group and the lists in it. The first call that fails is remembered; what comes after is harmless.
class ListWriter {
 public:
  ListWriter(hid_t parent, const std::string& name, bool& ok)
      : id_(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), ok_(ok) {
    note(bool(id_));
  }
  hid_t id() const { return id_.get(); }

  // As FCLIB's own programs do: 32-bit integers, contiguous.
  void integers(const char* name, const std::vector<std::int64_t>& values) const {
    write(name, H5T_STD_I32LE, H5T_NATIVE_INT64, values.size(), values.data());
  }
  void integer(const char* name, std::int64_t value) const { integers(name, {value}); }
  void reals(const char* name, const std::vector<double>& values) const {
    write(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.size(), values.data());
  }
  void text(const char* name, const std::string& value) const {
    const std::string cut = value.substr(0, longest_text - 1);
    const Handle type(H5Tcopy(H5T_C_S1)), space(H5Screate(H5S_SCALAR));
    note(H5Tset_size(type.get(), cut.size() + 1) >= 0);
    write_in(name, type.get(), type.get(), space.get(), cut.c_str());
  }

 private:
  void note(bool ok) const { ok_ = ok_ && ok; }
  void write(const char* name, hid_t stored, hid_t memory, hsize_t count, const void* values) const {
    const Handle space(H5Screate_simple(1, &count, nullptr));
    write_in(name, stored, memory, space.get(), count > 0 ? values : nullptr);
  }
  void write_in(const char* name, hid_t stored, hid_t memory, hid_t space, const void* values) const {
    const Handle set(H5Dcreate2(id_.get(), name, stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    note(set && (values == nullptr ||
                 H5Dwrite(set.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0));
  }

  Handle id_;
  bool& ok_;
};

void write_matrix(const ListWriter& local, const fclib::SparseMatrix& matrix, bool& ok) {
  const ListWriter group(local.id(), fclib::matrix_group, ok);
  group.integer(fclib::nzmax, matrix.nzmax);
  group.integer(fclib::m, matrix.rows);
  group.integer(fclib::n, matrix.columns);
  group.integer(fclib::nz, matrix.nz);
  group.integers(fclib::p, matrix.p);
  group.integers(fclib::i, matrix.i);
  group.reals(fclib::x, matrix.x);
}

void write_state(hid_t parent, const std::string& name, const ContactState& state, bool& ok) {
  const ListWriter group(parent, name, ok);
  group.reals(fclib::u, state.u);
  group.reals(fclib::r, state.r);
}

void write_all(hid_t file, const FclibProblem& contents, bool& ok) {
  const ContactProblem& problem = contents.problem;
  const ListWriter local(file, fclib::local, ok);
  local.integer(fclib::spacedim, 3);
  write_matrix(local, fclib::compressed_columns_of(problem.w), ok);
  const ListWriter vectors(local.id(), fclib::vectors, ok);
  vectors.reals(fclib::q, problem.q);
  vectors.reals(fclib::mu, problem.mu);
  const ListWriter info(local.id(), fclib::info, ok);
  info.text(fclib::title, problem.title);
  info.text(fclib::description, problem.description);
  info.text(fclib::math_info, problem.math_info);
  if (contents.solution) write_state(file, fclib::solution, *contents.solution, ok);
  if (contents.guesses.empty()) return;
  const ListWriter guesses(file, fclib::guesses, ok);
  guesses.integer(fclib::guess_count, static_cast<std::int64_t>(contents.guesses.size()));
  for (std::size_t k = 0; k < contents.guesses.size(); ++k)
    write_state(guesses.id(), std::to_string(k + 1), contents.guesses[k], ok);
}

Status check_states(const FclibProblem& contents) {
  const std::size_t size = contents.problem.q.size();
  const auto fits = [&](const ContactState& state) {
    return state.u.size() == size && state.r.size() == size;
  };
  bool fit = !contents.solution || fits(*contents.solution);
  for (const ContactState& guess : contents.guesses) fit = fit && fits(guess);
  if (fit) return {};
  return make_issue(IssueCode::contact_problem_invalid, "u or r has not the length of q", "solution");
}

// The file grows in `buffer`.
Status write_to(const FclibProblem& contents, storage::SegmentBuffer& buffer) {
  if (Status status = check_contact_problem(contents.problem); !status) return status;
  if (Status status = check_states(contents); !status) return status;
  try {
    const storage::Hdf5Session session;
    Handle file = storage::create_device(buffer);
    bool ok = bool(file);
    if (ok) write_all(file.get(), contents, ok);
    if (file.close() && ok) return {};
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
  return make_issue(IssueCode::io_out_of_memory, "HDF5 could not build the file");
}

}  // namespace

Status write_fclib(const FclibProblem& problem, const std::filesystem::path& file) {
  storage::SegmentBuffer buffer;
  if (Status status = write_to(problem, buffer); !status) return status;
  return replace_file(file, buffer.pieces());
}

Result<std::vector<std::byte>> write_fclib_memory(const FclibProblem& problem) {
  storage::SegmentBuffer buffer;
  if (Status status = write_to(problem, buffer); !status) return status.issue();
  std::vector<std::byte> bytes;
  for (const auto piece : buffer.pieces()) bytes.insert(bytes.end(), piece.begin(), piece.end());
  return bytes;
}

}  // namespace souple
