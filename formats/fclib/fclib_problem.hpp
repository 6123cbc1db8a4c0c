// SPDX-License-Identifier: MIT
// What a file in the local layout of FCLIB holds (Acary, Bremond, Huber: "FCLIB: a collection of
// discrete 3D Frictional Contact problems").
#pragma once
#include <optional>
#include <vector>

#include "formats/core/contact_problem.hpp"

namespace souple {

struct FclibProblem {
  ContactProblem problem;
  std::vector<ContactState> guesses;
  std::optional<ContactState> solution;  ///< as stored, which may be anything
};

}  // namespace souple
