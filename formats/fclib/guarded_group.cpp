// SPDX-License-Identifier: MIT
#include "formats/fclib/guarded_group.hpp"

#include <algorithm>

namespace souple::fclib {
namespace {

using storage::Handle;

constexpr std::uint64_t largest_list_bytes = std::uint64_t{4} << 30;
constexpr std::size_t largest_text_bytes = 64 << 10;
// Decoded bytes that deflated ones may stand for, beyond a small allowance (deflate reaches 1032).
constexpr std::uint64_t largest_ratio = 250, free_allowance = 1 << 20;

bool has_known_filters(hid_t creation) {
  const int count = H5Pget_nfilters(creation);
  for (int place = 0; place < count; ++place) {
    unsigned flags = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(place), &flags, &values,
                                               nullptr, 0, nullptr, nullptr);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      return false;
  }
  return count >= 0;
}

// Contiguous, compact or chunked, inside this file.
bool is_plain_storage(hid_t dataset) {
  const Handle creation(H5Dget_create_plist(dataset));
  if (!creation || H5Pget_external_count(creation.get()) != 0) return false;
  const H5D_layout_t layout = H5Pget_layout(creation.get());
  if (layout == H5D_CHUNKED) return has_known_filters(creation.get());
  return layout == H5D_CONTIGUOUS || layout == H5D_COMPACT;
}

bool is_hard_link(hid_t group, const char* name, H5O_type_t kind) {
  H5L_info_t link{};
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0 || H5Lget_info(group, name, &link, H5P_DEFAULT) < 0 ||
      link.type != H5L_TYPE_HARD)
    return false;
  H5O_info_t object{};
  return H5Oget_info_by_name(group, name, &object, H5P_DEFAULT) >= 0 && object.type == kind;
}

char printable(char c) { return (c >= ' ' && c <= '~') || c == '\n' ? c : '?'; }

}  // namespace

Issue GuardedGroup::damaged(const std::string& name, const std::string& what) const {
  return make_issue(IssueCode::contact_file_damaged, name + " " + what, where_);
}

Result<GuardedGroup> GuardedGroup::root(hid_t file, std::uint64_t file_bytes, std::string where) {
  Handle id(H5Gopen2(file, "/", H5P_DEFAULT));
  GuardedGroup group(std::move(id), file_bytes, std::move(where));
  if (!group.id_) return group.damaged("/", "cannot be opened");
  return group;
}

bool GuardedGroup::has(const char* name) const {
  return is_hard_link(id_.get(), name, H5O_TYPE_GROUP) ||
         is_hard_link(id_.get(), name, H5O_TYPE_DATASET);
}

Result<GuardedGroup> GuardedGroup::group(const std::string& name) const {
  if (!is_hard_link(id_.get(), name.c_str(), H5O_TYPE_GROUP))
    return damaged("group " + name, "is missing");
  GuardedGroup group(Handle(H5Gopen2(id_.get(), name.c_str(), H5P_DEFAULT)), file_bytes_,
                     where_ + "/" + name);
  if (!group.id_) return damaged("group " + name, "cannot be opened");
  return group;
}

Result<Handle> GuardedGroup::dataset(const std::string& name, H5T_class_t kind) const {
  if (!is_hard_link(id_.get(), name.c_str(), H5O_TYPE_DATASET)) return damaged(name, "is missing");
  Handle id(H5Dopen2(id_.get(), name.c_str(), H5P_DEFAULT));
  const Handle type(id ? H5Dget_type(id.get()) : H5I_INVALID_HID);
  if (!type) return damaged(name, "cannot be opened");
  if (H5Tget_class(type.get()) != kind) return damaged(name, "is of another type");
  if (!is_plain_storage(id.get())) return damaged(name, "is stored elsewhere or in an unknown way");
  return id;
}

Result<std::size_t> GuardedGroup::length(hid_t dataset, const std::string& name,
                                         std::size_t value_bytes) const {
  const Handle space(H5Dget_space(dataset)), type(H5Dget_type(dataset));
  const hssize_t points =
      space && H5Sis_simple(space.get()) > 0 ? H5Sget_simple_extent_npoints(space.get()) : hssize_t{-1};
  const std::uint64_t count = static_cast<std::uint64_t>(points), width = H5Tget_size(type.get());
  if (points < 0 || width == 0 || width > 64) return damaged(name, "has no usable extent");
  if (count > largest_list_bytes / std::max<std::uint64_t>(width, value_bytes))
    return make_issue(IssueCode::contact_problem_too_large,
                      name + " claims " + std::to_string(count) + " values", where_);
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  if (stored > file_bytes_ || count * width > largest_ratio * stored + free_allowance ||
      (count > 0 && stored == 0))
    return damaged(name, "claims " + std::to_string(count) + " values, but stores " +
                             std::to_string(stored) + " bytes");
  return static_cast<std::size_t>(count);
}

Result<std::vector<std::int64_t>> GuardedGroup::integers(const char* name) const {
  const Result<Handle> id = dataset(name, H5T_INTEGER);
  if (!id) return id.issue();
  const Result<std::size_t> count = length(id->get(), name, sizeof(std::int64_t));
  if (!count) return count.issue();
  std::vector<std::int64_t> values(*count);
  if (*count > 0 &&
      H5Dread(id->get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    return damaged(name, "cannot be read");
  return values;
}

Result<std::vector<double>> GuardedGroup::reals(const char* name) const {
  const Result<Handle> id = dataset(name, H5T_FLOAT);
  if (!id) return id.issue();
  const Result<std::size_t> count = length(id->get(), name, sizeof(double));
  if (!count) return count.issue();
  std::vector<double> values(*count);
  if (*count > 0 &&
      H5Dread(id->get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    return damaged(name, "cannot be read");
  return values;
}

Result<std::int64_t> GuardedGroup::integer(const char* name) const {
  const Result<std::vector<std::int64_t>> values = integers(name);
  if (!values) return values.issue();
  if (values->size() != 1) return damaged(name, "is not one number");
  return values->front();
}

std::string GuardedGroup::text(const char* name) const {
  const Result<Handle> id = dataset(name, H5T_STRING);
  if (!id) return {};
  const Handle type(H5Dget_type(id->get())), space(H5Dget_space(id->get()));
  const std::size_t bytes = H5Tget_size(type.get());
  if (H5Tis_variable_str(type.get()) != 0 || bytes == 0 || bytes > largest_text_bytes ||
      H5Sget_simple_extent_npoints(space.get()) != 1)
    return {};
  std::string text(bytes, '\0');
  if (H5Dread(id->get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) return {};
  text.resize(std::min(text.find('\0'), text.size()));
  std::ranges::transform(text, text.begin(), printable);
  return text;
}

}  // namespace souple::fclib
