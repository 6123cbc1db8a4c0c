// SPDX-License-Identifier: MIT
#pragma once
#include <memory>

namespace souple {

/// Memory of the searches for close pairs: grows to what is needed, then stays. One per thread that
/// searches; it holds nothing from one search to the next that would change a result.
class ProximityWork {
 public:
  ProximityWork();
  ~ProximityWork();
  ProximityWork(ProximityWork&&) noexcept;
  ProximityWork& operator=(ProximityWork&&) noexcept;

  struct Arrays;
  Arrays& arrays() { return *arrays_; }

 private:
  std::unique_ptr<Arrays> arrays_;
};

}  // namespace souple
