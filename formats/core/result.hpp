// SPDX-License-Identifier: MIT
#pragma once
#include <cassert>
#include <optional>
#include <utility>
#include <variant>

#include "formats/core/issue.hpp"

namespace souple {

/// A value, or the issue that prevented it. Libraries return it instead of throwing.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Issue issue) : state_(std::in_place_index<1>, std::move(issue)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & {
    assert(ok());
    return *std::get_if<0>(&state_);
  }
  const T& value() const& {
    assert(ok());
    return *std::get_if<0>(&state_);
  }
  T&& value() && {
    assert(ok());
    return std::move(*std::get_if<0>(&state_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Issue& issue() const {
    assert(!ok());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Issue> state_;
};

/// Success, or the issue that prevented it.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Issue issue) : issue_(std::move(issue)) {}

  bool ok() const { return !issue_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Issue& issue() const {
    assert(!ok());
    return *issue_;
  }

 private:
  std::optional<Issue> issue_;
};

}  // namespace souple
