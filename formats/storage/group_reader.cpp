// SPDX-License-Identifier: MIT
#include "formats/storage/group_reader.hpp"

#include <algorithm>
#include <cmath>

#include "formats/core/limits.hpp"
#include "formats/core/names.hpp"
#include "formats/storage/object_header.hpp"

namespace souple::storage {
namespace {

struct NameList {
  std::vector<std::string> names;
  std::size_t limit;
  bool refused = false;
};

/// Positive ends the iteration.
herr_t collect_name(hid_t, const char* name, const H5L_info_t* info, void* data) {
  auto& list = *static_cast<NameList*>(data);
  try {
    list.refused =
        info->type != H5L_TYPE_HARD || list.names.size() >= list.limit || !is_valid_name(name);
    if (!list.refused) list.names.emplace_back(name);
  } catch (const std::bad_alloc&) {
    list.refused = true;
  }
  return list.refused ? 1 : 0;
}

}  // namespace

Issue GroupReader::damaged(const std::string& what) const {
  return make_issue(IssueCode::asset_corrupt, what, where_);
}

Result<GroupReader> GroupReader::root(hid_t file, ByteDevice& device, std::string where) {
  GroupReader group({}, device, std::move(where));
  group.id_ = Handle(H5Gopen2(file, "/", H5P_DEFAULT));
  if (!group.id_) return group.damaged("the root group cannot be opened");
  return group;
}

Result<bool> GroupReader::has(const std::string& name) const {
  const htri_t found = H5Lexists(id_.get(), name.c_str(), H5P_DEFAULT);
  if (found < 0) return damaged("the links cannot be read");
  return found > 0;
}

Status GroupReader::check_link(const std::string& name, ObjectKind kind) const {
  // An impossible name ("a/b", ".") would lead HDF5 elsewhere.
  const Result<bool> found = is_valid_name(name) ? has(name) : Result<bool>(false);
  if (!found) return found.issue();
  if (!*found) return make_issue(IssueCode::asset_missing_part, "no " + name, where_);
  H5L_info_t link{};
  if (H5Lget_info(id_.get(), name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)
    return damaged(name + " is a link to elsewhere");
  if (!is_sound_object(*device_, link.u.address, kind))
    return damaged("the header of " + name + " is damaged or of an unexpected kind");
  return {};
}

Result<GroupReader> GroupReader::group(const std::string& name) const {
  if (Status status = check_link(name, ObjectKind::group); !status) return status.issue();
  Handle id(H5Gopen2(id_.get(), name.c_str(), H5P_DEFAULT));
  if (!id) return damaged(name + " cannot be opened");
  return GroupReader(std::move(id), *device_, where_ + "/" + name);
}

Result<DatasetReader> GroupReader::dataset(const std::string& name) const {
  if (Status status = check_link(name, ObjectKind::dataset); !status) return status.issue();
  return DatasetReader::open(id_.get(), name, where_ + "/" + name, device_->size());
}

Result<std::vector<std::string>> GroupReader::child_names(std::size_t limit) const {
  NameList list{{}, limit};
  hsize_t position = 0;
  if (H5Literate(id_.get(), H5_INDEX_NAME, H5_ITER_INC, &position, collect_name, &list) < 0)
    return damaged("the links cannot be read");
  if (list.refused)
    return damaged("a link to elsewhere, an impossible name, or more than " + std::to_string(limit) +
                   " entries");
  return std::move(list.names);
}

Result<bool> GroupReader::has_attribute(const char* attribute) const {
  const htri_t found = H5Aexists(id_.get(), attribute);
  if (found < 0) return damaged("the attributes cannot be read");
  return found > 0;
}

Result<Handle> GroupReader::scalar_attribute(const char* attribute) const {
  if (const Result<bool> found = has_attribute(attribute); !found || !*found)
    return found ? damaged(std::string("no attribute ") + attribute) : found.issue();
  Handle id(H5Aopen(id_.get(), attribute, H5P_DEFAULT));
  const Handle space(id ? H5Aget_space(id.get()) : H5I_INVALID_HID);
  if (!space || H5Sget_simple_extent_type(space.get()) != H5S_SCALAR)
    return damaged(std::string("attribute ") + attribute + " is not one value");
  return id;
}

Result<std::string> GroupReader::text(const char* attribute) const {
  const Result<Handle> opened = scalar_attribute(attribute);
  if (!opened) return opened.issue();
  const Handle type(H5Aget_type(opened->get()));
  if (!type || H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      H5Tget_size(type.get()) > limits::text_bytes)
    return damaged(std::string("attribute ") + attribute + " is not a text of fixed length");
  std::string text(H5Tget_size(type.get()), '\0');
  if (H5Aread(opened->get(), type.get(), text.data()) < 0)
    return damaged(std::string("attribute ") + attribute + " cannot be read");
  text.resize(text.find_last_not_of('\0') + 1);  // npos + 1 = 0: all padding
  if (!is_valid_text(text))
    return damaged(std::string("attribute ") + attribute + " is not valid text");
  return text;
}

Result<double> GroupReader::real(const char* attribute) const {
  const Result<Handle> opened = scalar_attribute(attribute);
  if (!opened) return opened.issue();
  const Handle type(H5Aget_type(opened->get()));
  double value = 0;
  if (!type || H5Tequal(type.get(), H5T_IEEE_F64LE) <= 0 ||
      H5Aread(opened->get(), H5T_IEEE_F64LE, &value) < 0 || !std::isfinite(value))
    return damaged(std::string("attribute ") + attribute + " is not a finite float64");
  return value;
}

Result<double> GroupReader::real_or(const char* attribute, double otherwise) const {
  const Result<bool> found = has_attribute(attribute);
  if (!found) return found.issue();
  return *found ? real(attribute) : Result<double>(otherwise);
}

Result<std::int64_t> GroupReader::integer(const char* attribute) const {
  const Result<Handle> opened = scalar_attribute(attribute);
  if (!opened) return opened.issue();
  const Handle type(H5Aget_type(opened->get()));
  std::int64_t value = 0;
  if (!type || H5Tequal(type.get(), H5T_STD_I64LE) <= 0 ||
      H5Aread(opened->get(), H5T_STD_I64LE, &value) < 0)
    return damaged(std::string("attribute ") + attribute + " is not an int64");
  return value;
}

Result<std::int64_t> GroupReader::integer_or(const char* attribute, std::int64_t otherwise) const {
  const Result<bool> found = has_attribute(attribute);
  if (!found) return found.issue();
  return *found ? integer(attribute) : Result<std::int64_t>(otherwise);
}

}  // namespace souple::storage
