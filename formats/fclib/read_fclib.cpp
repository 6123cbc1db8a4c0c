// SPDX-License-Identifier: MIT
#include "formats/fclib/read_fclib.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "formats/fclib/guarded_group.hpp"
#include "formats/fclib/names.hpp"
#include "formats/fclib/sparse_entries.hpp"
#include "formats/storage/byte_device.hpp"
#include "formats/storage/device_driver.hpp"

namespace souple {
namespace {

using fclib::GuardedGroup;

constexpr std::int64_t most_guesses = 100;

Issue unsupported(std::string what, const std::string& where) {
  return make_issue(IssueCode::unsupported_feature, std::move(what), where,
                    "Problems of the local layout in three dimensions without equality constraints "
                    "are solved.");
}

Status check_kind(const GuardedGroup& root) {
  if (root.has(fclib::local)) return {};
  for (const char* other : {fclib::global, fclib::rolling})
    if (root.has(other))
      return unsupported("the problem is of the layout " + std::string(other), root.where());
  return make_issue(IssueCode::contact_file_damaged,
                    "group " + std::string(fclib::local) + " is missing", root.where());
}

Status check_features(const GuardedGroup& local) {
  const Result<std::int64_t> dimensions = local.integer(fclib::spacedim);
  if (!dimensions) return dimensions.issue();
  if (*dimensions != 3)
    return unsupported("the problem is one of " + std::to_string(*dimensions) + " dimensions",
                       local.where());
  for (const char* name : {fclib::constraint_v, fclib::constraint_r})
    if (local.has(name)) return unsupported("the problem has equality constraints", local.where());
  return {};
}

// Assigns the value of a result, or hands its issue on.
template <class T>
Status take(Result<T> result, T& target) {
  if (!result) return result.issue();
  target = std::move(*result);
  return {};
}

Result<BlockColumns> read_matrix(const GuardedGroup& local) {
  const Result<GuardedGroup> group = local.group(fclib::matrix_group);
  if (!group) return group.issue();
  fclib::SparseMatrix matrix;
  for (const auto& [name, target] :
       {std::pair{fclib::nzmax, &matrix.nzmax}, std::pair{fclib::m, &matrix.rows},
        std::pair{fclib::n, &matrix.columns}, std::pair{fclib::nz, &matrix.nz}})
    if (Status status = take(group->integer(name), *target); !status) return status.issue();
  for (const auto& [name, target] : {std::pair{fclib::p, &matrix.p}, std::pair{fclib::i, &matrix.i}})
    if (Status status = take(group->integers(name), *target); !status) return status.issue();
  if (Status status = take(group->reals(fclib::x), matrix.x); !status) return status.issue();
  return blocks_of(matrix, group->where());
}

Status read_vectors(const GuardedGroup& local, ContactProblem& problem) {
  const Result<GuardedGroup> vectors = local.group(fclib::vectors);
  if (!vectors) return vectors.issue();
  if (vectors->has(fclib::s))
    return unsupported("the problem has equality constraints", vectors->where());
  if (Status status = take(vectors->reals(fclib::q), problem.q); !status) return status;
  return take(vectors->reals(fclib::mu), problem.mu);
}

void read_texts(const GuardedGroup& local, ContactProblem& problem) {
  if (!local.has(fclib::info)) return;
  const Result<GuardedGroup> info = local.group(fclib::info);
  if (!info) return;
  problem.title = info->text(fclib::title);
  problem.description = info->text(fclib::description);
  problem.math_info = info->text(fclib::math_info);
}

bool is_usable(const std::vector<double>& values, std::size_t size) {
  return values.size() == size && std::ranges::all_of(values, [](double value) {
           return std::abs(value) <= limits::contact_number;
         });
}

// Nothing unless u and r are there and usable.
std::optional<ContactState> read_state(const GuardedGroup& parent, const std::string& name,
                                       std::size_t size) {
  const Result<GuardedGroup> group = parent.group(name);
  if (!group) return std::nullopt;
  Result<std::vector<double>> u = group->reals(fclib::u), r = group->reals(fclib::r);
  if (!u || !r || !is_usable(*u, size) || !is_usable(*r, size)) return std::nullopt;
  return ContactState{std::move(*u), std::move(*r)};
}

void read_guesses(const GuardedGroup& root, FclibProblem& file) {
  const Result<GuardedGroup> group = root.group(fclib::guesses);
  if (!group) return;
  const Result<std::int64_t> count = group->integer(fclib::guess_count);
  for (std::int64_t k = 1; count && k <= std::min(*count, most_guesses); ++k)
    if (auto state = read_state(*group, std::to_string(k), file.problem.q.size()))
      file.guesses.push_back(std::move(*state));
}

Result<FclibProblem> read_opened(storage::ByteDevice& device, const std::string& where) {
  const storage::Hdf5Session session;
  const storage::Handle opened = storage::open_device(device);
  if (!opened) return make_issue(IssueCode::contact_file_damaged, "the file is not HDF5", where);
  const Result<GuardedGroup> root = GuardedGroup::root(opened.get(), device.size(), where);
  if (!root) return root.issue();
  if (Status status = check_kind(*root); !status) return status.issue();
  const Result<GuardedGroup> local = root->group(fclib::local);
  if (!local) return local.issue();
  if (Status status = check_features(*local); !status) return status.issue();
  FclibProblem file;
  if (Status status = take(read_matrix(*local), file.problem.w); !status) return status.issue();
  if (Status status = read_vectors(*local, file.problem); !status) return status.issue();
  if (Status status = check_contact_problem(file.problem); !status) {
    Issue issue = status.issue();
    issue.where = local->where() + "/" + issue.where;
    return issue;
  }
  read_texts(*local, file.problem);
  read_guesses(*root, file);
  file.solution = read_state(*root, fclib::solution, file.problem.q.size());
  return file;
}

// Lack of memory becomes an issue; nothing else below throws.
Result<FclibProblem> read_guarded(storage::ByteDevice& device, const std::string& where) {
  try {
    return read_opened(device, where);
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what(), where);
  }
}

}  // namespace

Result<FclibProblem> read_fclib(const std::filesystem::path& file) {
  const Result<std::unique_ptr<storage::ByteDevice>> device = storage::open_file_view(file);
  if (!device) return device.issue();
  return read_guarded(**device, file.string());
}

Result<FclibProblem> read_fclib_memory(std::span<const std::byte> bytes, const std::string& where) {
  const std::unique_ptr<storage::ByteDevice> device = storage::make_memory_view(bytes);
  return read_guarded(*device, where);
}

}  // namespace souple
