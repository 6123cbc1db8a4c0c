// SPDX-License-Identifier: MIT
// The state of a world as bytes. One walk over the state serves writing, checking and reading, so that
// the three cannot disagree; what is read is checked from end to end before anything is changed.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> magic{'S', 'O', 'U', 'P', 'S', 'N', 'A', 'P'};
constexpr std::uint32_t snapshot_version = 1;

// FNV-1a, 64 bits: against damage, not against forgery, from which the checks of sizes protect.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const std::byte b : bytes) hash = (hash ^ std::uint64_t(b)) * 1099511628211ull;
  return hash;
}

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  bool local(void* data, std::size_t size) { return state(data, size); }
  bool state(void* data, std::size_t size) {
    const auto* from = static_cast<const std::byte*>(data);
    out_.insert(out_.end(), from, from + size);
    return true;
  }
  bool doubles(double* data, std::size_t count) { return state(data, count * sizeof(double)); }
  template <class T>
  bool resize(std::vector<T>&, std::uint64_t) {
    return true;
  }

 private:
  std::vector<std::byte>& out_;
};

/// Reads what the walk needs to go on, leaves the state alone.
class Checker {
 public:
  explicit Checker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool local(void* data, std::size_t size) {
    if (size > bytes_.size()) return false;
    std::memcpy(data, bytes_.data(), size);
    return state(data, size);
  }
  bool state(void*, std::size_t size) {
    if (size > bytes_.size()) return false;
    bytes_ = bytes_.subspan(size);
    return true;
  }
  bool doubles(double*, std::size_t count) {
    if (count > bytes_.size() / sizeof(double)) return false;
    for (; count > 0; --count) {
      double value;
      if (!local(&value, sizeof value) || !std::isfinite(value)) return false;
    }
    return true;
  }
  template <class T>
  bool resize(std::vector<T>&, std::uint64_t count) {
    return count <= bytes_.size() / sizeof(T);
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// Of bytes that a Checker has seen.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : next_(bytes.data()) {}
  bool local(void* data, std::size_t size) { return state(data, size); }
  bool state(void* data, std::size_t size) {
    if (size > 0) std::memcpy(data, next_, size);
    next_ += size;
    return true;
  }
  bool doubles(double* data, std::size_t count) { return state(data, count * sizeof(double)); }
  template <class T>
  bool resize(std::vector<T>& list, std::uint64_t count) {
    list.resize(count);
    return true;
  }

 private:
  const std::byte* next_;
};

// What both sides know already; the same in the bytes, or they are of another world.
template <class Stream, class T>
bool same(Stream& s, const T& known) {
  T value = known;
  return s.local(&value, sizeof value) && value == known;
}

template <class Stream>
bool walk(Stream& s, Eigen::VectorXd& vector) {
  return same(s, std::uint64_t(vector.size())) && s.doubles(vector.data(), std::size_t(vector.size()));
}

template <class Stream>
bool walk(Stream& s, std::vector<Vec3>& list, std::uint64_t count) {
  return s.resize(list, count) && s.doubles(list.empty() ? nullptr : list.front().data(), 3 * count);
}

template <class Stream>
bool walk(Stream& s, SoftBody& body) {
  bool has_history = body.history.valid;
  StepSolver::Memory solver = body.solver->memory();
  if (!walk(s, body.x) || !walk(s, body.v) || !s.local(&has_history, sizeof has_history) ||
      !walk(s, body.history.motion) || !walk(s, body.history.velocity) ||
      !s.local(&solver, sizeof solver) || !body.solver->may_recall(solver))
    return false;
  if constexpr (std::is_same_v<Stream, Reader>) {
    body.history.valid = has_history;
    body.history.begun = false;
    body.solver->recall(solver);
  }
  return true;
}

}  // namespace

template <class Stream>
bool World::State::walk_state(Stream& s) {
  if (!same(s, magic) || !same(s, snapshot_version) || !same(s, settings.integrator) ||
      !same(s, settings.time_step_s) || !same(s, std::uint64_t(bodies.size())))
    return false;
  for (const auto index : soft_indices)
    if (!same(s, index) || !walk(s, soft(index))) return false;
  std::uint64_t count = last_keys.size();
  return s.doubles(&time, 1) && s.doubles(&relaxation, 1) &&
         s.state(&growing_steps, sizeof growing_steps) &&
         s.state(&last_energy_j, sizeof last_energy_j) && s.local(&count, sizeof count) &&
         s.resize(last_keys, count) && s.state(last_keys.data(), count * sizeof(ContactKey)) &&
         walk(s, last_forces, count) && walk(s, last_changes, count) && walk(s, last_lasting, count) &&
         s.resize(last_courses, count) &&
         s.doubles(last_courses.empty() ? nullptr : last_courses.front().front().data(), 9 * count);
}

std::vector<std::byte> World::snapshot() const {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  state_->walk_state(writer);  // changes nothing when it writes
  std::uint64_t sum = checksum(bytes);
  writer.local(&sum, sizeof sum);
  return bytes;
}

Status World::restore(std::span<const std::byte> bytes) {
  const auto refuse = [](const char* what) { return make_issue(IssueCode::snapshot_invalid, what); };
  std::uint64_t sum = 0;
  if (bytes.size() < sizeof sum) return refuse("too short for a snapshot");
  const auto content = bytes.first(bytes.size() - sizeof sum);
  std::memcpy(&sum, bytes.data() + content.size(), sizeof sum);
  if (sum != checksum(content)) return refuse("its bytes are damaged: the checksum differs");
  Checker checker(content);
  if (!state_->walk_state(checker) || !checker.at_end())
    return refuse("it is of a world with other bodies, another time step, integrator or solver");
  Reader reader(content);
  state_->walk_state(reader);
  state_->forget_contacts();
  return {};
}

}  // namespace souple
