// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/hand_path_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

constexpr std::size_t file_limit = std::size_t{256} << 20;
constexpr std::size_t line_limit = 4096;

enum Quantity : std::uint8_t { time, x, y, z, qw, qx, qy, qz, opening, quantity_count };

struct ColumnKind {
  std::string_view name;
  Quantity quantity;
  double unit;  ///< SI units to one of the file's
};

constexpr double degree = std::numbers::pi / 180;
constexpr std::array<ColumnKind, 18> column_kinds{{
    {"time_s", time, 1},
    {"time_ms", time, 1e-3},
    {"time_us", time, 1e-6},
    {"x_m", x, 1},
    {"x_cm", x, 1e-2},
    {"x_mm", x, 1e-3},
    {"y_m", y, 1},
    {"y_cm", y, 1e-2},
    {"y_mm", y, 1e-3},
    {"z_m", z, 1},
    {"z_cm", z, 1e-2},
    {"z_mm", z, 1e-3},
    {"qw", qw, 1},
    {"qx", qx, 1},
    {"qy", qy, 1},
    {"qz", qz, 1},
    {"opening_rad", opening, 1},
    {"opening_deg", opening, degree},
}};

constexpr std::string_view separators = ",; \t";

/// The words of a line. Several blanks part as one; two commas have nothing between them.
std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  bool after_comma = true;
  std::size_t at = 0;
  while (at <= line.size()) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    const bool comma = end < line.size() && (line[end] == ',' || line[end] == ';');
    if (end > at || (comma && after_comma)) words.push_back(line.substr(at, end - at));
    if (comma)
      after_comma = true;
    else if (end > at)
      after_comma = false;
    at = end + 1;
  }
  return words;
}

std::string quoted(std::string_view word) {
  std::string text = "\"";
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 40 ? "...\"" : "\"");
}

class PathParser {
 public:
  PathParser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Result<RecordedPath> parse() {
    std::string_view line;
    while (status_ && next_line(line)) {
      if (columns_.empty())
        read_header(line);
      else
        read_sample(line);
    }
    if (status_ && columns_.empty()) refuse(IssueCode::hand_path_malformed, "there is no header line");
    if (!status_) return status_.issue();
    auto path = RecordedPath::create(std::move(samples_));
    if (path) return path;
    Issue issue = path.issue();
    issue.where = name_ + (issue.where.empty() ? "" : ": " + issue.where);
    return issue;
  }

 private:
  /// The next one that says something.
  bool next_line(std::string_view& line) {
    while (at_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      line = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      if (number_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
      if (line.ends_with('\r')) line.remove_suffix(1);
      const std::size_t begin = line.find_first_not_of(" \t");
      if (begin == std::string_view::npos || line[begin] == '#') continue;
      line = line.substr(begin, line.find_last_not_of(" \t") + 1 - begin);
      if (line.size() <= line_limit) return true;
      refuse(IssueCode::hand_path_malformed, "a line of more than 4096 bytes");
      return false;
    }
    return false;
  }

  void read_header(std::string_view line) {
    std::array<int, quantity_count> met{};
    for (const std::string_view word : split(line)) {
      const auto kind = std::ranges::find(column_kinds, word, &ColumnKind::name);
      if (kind == column_kinds.end())
        return refuse(IssueCode::hand_path_malformed,
                      quoted(word) + " is no column; there are time_s, x_m, y_m, z_m, qw, qx, qy, qz " +
                          "and opening_rad, and other units of them");
      if (met[kind->quantity]++ > 0)
        return refuse(IssueCode::hand_path_malformed, "column " + quoted(word) + " is there twice");
      columns_.push_back(&*kind);
    }
    for (const Quantity needed : {time, x, y, z})
      if (met[needed] == 0)
        return refuse(IssueCode::hand_path_malformed, "the header needs time, x, y and z, with units");
    if (const int turns = met[qw] + met[qx] + met[qy] + met[qz]; turns != 0 && turns != 4)
      refuse(IssueCode::hand_path_malformed, "a quaternion needs qw, qx, qy and qz");
  }

  void read_sample(std::string_view line) {
    const std::vector<std::string_view> words = split(line);
    if (words.size() != columns_.size())
      return refuse(IssueCode::hand_path_malformed, std::to_string(words.size()) + " values for " +
                                                        std::to_string(columns_.size()) + " columns");
    if (samples_.size() >= RecordedPath::sample_limit)
      return refuse(IssueCode::hand_path_too_large, "more than ten million samples");
    std::array<double, quantity_count> values{};
    values[qw] = 1;
    for (std::size_t k = 0; k < words.size(); ++k) {
      const auto value = parse_number(words[k]);
      if (!value)
        return refuse(IssueCode::hand_path_bad_value, quoted(words[k]) + " is no finite number");
      values[columns_[k]->quantity] = *value * columns_[k]->unit;
    }
    add(values);
  }

  void add(const std::array<double, quantity_count>& v) {
    DeviceSample sample{v[time], {{v[qw], v[qx], v[qy], v[qz]}, {v[x], v[y], v[z]}}, v[opening]};
    const double length = std::hypot(std::hypot(v[qw], v[qx]), std::hypot(v[qy], v[qz]));
    if (!(length > 1e-9 && length < 1e9))
      return refuse(IssueCode::hand_path_bad_value, "the quaternion has no length");
    for (double& q : sample.pose.rotation) q /= length;
    if (!samples_.empty() && !(sample.time_s > samples_.back().time_s))
      return refuse(IssueCode::hand_path_bad_time, exact_text(sample.time_s) + " s after " +
                                                       exact_text(samples_.back().time_s) + " s");
    samples_.push_back(sample);
  }

  void refuse(IssueCode code, const std::string& what) {
    if (status_) status_ = make_issue(code, what, name_ + ":" + std::to_string(number_));
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_ = 0, number_ = 0;
  Status status_;
  std::vector<const ColumnKind*> columns_;
  std::vector<DeviceSample> samples_;
};

}  // namespace

Result<RecordedPath> parse_hand_path(std::string_view text, const std::string& name) {
  return PathParser(text, name).parse();
}

Result<RecordedPath> read_hand_path(const std::filesystem::path& file) {
  const auto text = read_text_file(file, file_limit);
  if (text) return parse_hand_path(*text, file.filename().string());
  Issue issue = text.issue();
  if (issue.code == IssueCode::io_file_too_large) issue.code = IssueCode::hand_path_too_large;
  return issue;
}

}  // namespace souple
