// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/solve_contact_input.hpp"

#include <cstring>

#include "formats/fclib/read_fclib.hpp"
#include "tools/process/child_answer.hpp"
#include "tools/process/child_process.hpp"
#include "tools/process/regular_file.hpp"

namespace souple {
namespace {

constexpr std::size_t largest_file_bytes = std::size_t{4} << 30;
constexpr ChildLimits child_limits{120, std::size_t{12} << 30};

// Lists of the answer, each after its length; native byte order: both ends are one program.
class Packer {
 public:
  template <class Container>
  void add(const Container& values) {
    const std::uint64_t count = values.size();
    bytes_.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes_.append(reinterpret_cast<const char*>(values.data()), count * sizeof(values[0]));
  }
  void add(const ContactState& state) {
    add(state.u);
    add(state.r);
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  template <class Container>
  void take(Container& values) {
    std::uint64_t count = 0;
    if (!sound_ || rest_.size() < sizeof count) return fail();
    std::memcpy(&count, rest_.data(), sizeof count);
    rest_.remove_prefix(sizeof count);
    if (count > rest_.size() / sizeof(values[0])) return fail();
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), rest_.data(), count * sizeof(values[0]));
    rest_.remove_prefix(count * sizeof(values[0]));
  }
  void take(ContactState& state) {
    take(state.u);
    take(state.r);
  }
  bool at_end() const { return rest_.empty(); }
  bool sound() const { return sound_; }

 private:
  void fail() { sound_ = false; }

  std::string_view rest_;
  bool sound_ = true;
};

std::string pack(const FclibProblem& file) {
  const ContactProblem& problem = file.problem;
  Packer packer;
  for (const std::string* text : {&problem.title, &problem.description, &problem.math_info})
    packer.add(*text);
  packer.add(problem.w.begin);
  packer.add(problem.w.row);
  packer.add(problem.w.value);
  packer.add(problem.q);
  packer.add(problem.mu);
  for (const ContactState& guess : file.guesses) packer.add(guess);
  return packer.take();
}

// The stored solution is left out: no one may trust it.
Result<FclibProblem> unpack(std::string_view bytes, const std::string& where) {
  FclibProblem file;
  ContactProblem& problem = file.problem;
  Unpacker unpacker(bytes);
  for (std::string* text : {&problem.title, &problem.description, &problem.math_info})
    unpacker.take(*text);
  unpacker.take(problem.w.begin);
  unpacker.take(problem.w.row);
  unpacker.take(problem.w.value);
  unpacker.take(problem.q);
  unpacker.take(problem.mu);
  while (unpacker.sound() && !unpacker.at_end()) unpacker.take(file.guesses.emplace_back());
  if (!unpacker.sound())
    return make_issue(IssueCode::contact_file_damaged, "the reader's answer is damaged", where);
  if (Status status = check_contact_problem(problem); !status) return status.issue();
  return file;
}

// What ends a reader says that the file is damaged.
Issue as_damage(Issue issue, const std::string& file) {
  if (issue.code == IssueCode::surface_reader_crashed ||
      issue.code == IssueCode::surface_reader_timeout || issue.code == IssueCode::surface_reader_memory)
    issue = make_issue(IssueCode::contact_file_damaged, "reading it failed: " + issue.what);
  issue.where = file;
  return issue;
}

}  // namespace

Result<FclibProblem> read_contact_problem(const std::string& file) {
  const Result<std::string> bytes = read_regular_file(file, largest_file_bytes);
  if (!bytes) return bytes.issue();
  const Result<std::string> sealed = run_in_child(
      [&] {
        const Result<FclibProblem> read =
            read_fclib_memory(std::as_bytes(std::span(bytes->data(), bytes->size())), file);
        return seal_answer(read ? Result<std::string>(pack(*read)) : read.issue());
      },
      child_limits);
  if (!sealed) return as_damage(sealed.issue(), file);
  const Result<std::string_view> answer = open_answer(*sealed);
  if (!answer) return as_damage(answer.issue(), file);
  return unpack(*answer, file);
}

}  // namespace souple
