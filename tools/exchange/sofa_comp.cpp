// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/sofa_comp.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "tools/exchange/atomic_file.hpp"

namespace souple {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t rows_at_once = 192;

/// Hours of solves must not end at a full disk.
Status check_room(const fs::path& file, std::int64_t row_count) {
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  const double needed = 8.0 * static_cast<double>(row_count) * static_cast<double>(row_count);
  if (error || needed <= static_cast<double>(space.available)) return {};
  return make_issue(IssueCode::io_cannot_write,
                    "the file takes " + std::to_string(static_cast<std::int64_t>(needed / 1e6)) +
                        " MB, there is room for " + std::to_string(space.available / 1'000'000) + " MB",
                    file.string());
}

}  // namespace

std::string sofa_comp_name(std::string_view scene_node, std::int64_t row_count, double time_step_s) {
  std::ostringstream name;
  name.imbue(std::locale::classic());
  name << scene_node << "-" << row_count << "-" << time_step_s << ".comp";
  return name.str();
}

Status write_sofa_comp(const fs::path& file, std::int64_t row_count, double time_step_s,
                       const ComplianceRows& rows, const std::function<void(double)>& progress) {
  if (auto status = check_room(file, row_count); !status) return status;
  return write_pieces_atomically(file, [&](const AppendBytes& append) -> Status {
    std::vector<double> values;
    for (std::int64_t first = 0; first < row_count; first += rows_at_once) {
      const std::int64_t count = std::min(rows_at_once, row_count - first);
      values.resize(static_cast<std::size_t>(count * row_count));
      if (auto status = rows(first, count, values); !status) return status;
      for (double& value : values) value /= time_step_s;
      const auto bytes = std::as_bytes(std::span(values));
      if (auto status = append({reinterpret_cast<const char*>(bytes.data()), bytes.size()}); !status)
        return status;
      if (progress) progress(static_cast<double>(first + count) / static_cast<double>(row_count));
    }
    return {};
  });
}

}  // namespace souple
