// SPDX-License-Identifier: MIT
#include "formats/read/internal/read_compliance.hpp"

#include <algorithm>
#include <utility>

#include "formats/core/limits.hpp"
#include "formats/read/internal/take.hpp"
#include "formats/storage/layout.hpp"

namespace souple::storage {
namespace {

using Rows4 = std::vector<std::array<Index, 4>>;
using Weights4 = std::vector<std::array<double, 4>>;

/// The value whose text this is; the texts stand in the order of the enumeration.
template <class Enumeration, std::size_t N>
Result<Enumeration> read_choice(const GroupReader& group, const char* attribute,
                                const std::array<std::string_view, N>& texts, IssueCode unknown) {
  const Result<std::string> text = group.text(attribute);
  if (!text) return text.issue();
  const auto found = std::ranges::find(texts, *text);
  if (found == texts.end())
    return make_issue(unknown, std::string(attribute) + " is \"" + *text + "\"", group.where());
  return static_cast<Enumeration>(found - texts.begin());
}

Result<ErrorNorm> read_error_norm(const GroupReader& group) {
  const Result<bool> found = group.has_attribute(layout::error_norm);
  if (!found) return found.issue();
  if (!*found) return ErrorNorm::scaled_spectral;
  return read_choice<ErrorNorm>(group, layout::error_norm, layout::error_norms,
                                IssueCode::unsupported_representation);
}

/// Attributes that version 1.2 brought.
Status read_attributes_of_1_2(const GroupReader& group, ComplianceHeader& header) {
  Status status;
  (void)(take(read_error_norm(group), header.error_norm, status) &&
         take(group.real_or(layout::shift, 0), header.shift, status) &&
         take(group.integer_or(layout::coarsening, 0), header.coarsening, status));
  return status;
}

/// A list that is absent if it has no entries.
template <class Row>
Result<std::vector<Row>> read_rows_if_any(const GroupReader& group, const char* name,
                                          std::uint64_t row_limit) {
  const Result<bool> found = group.has(name);
  if (!found) return found.issue();
  return *found ? read_rows<Row>(group, name, row_limit) : Result<std::vector<Row>>(std::vector<Row>{});
}

Result<std::vector<RowProlongation>> read_prolongation(const GroupReader& group,
                                                       const checks::MeshCounts& finest) {
  Status status;
  Rows4 rows;
  Weights4 weights;
  const bool read =
      take(read_rows_if_any<Rows4::value_type>(group, layout::prolongation_rows, finest.nodes), rows,
           status) &&
      take(read_rows_if_any<Weights4::value_type>(group, layout::prolongation_weights, finest.nodes),
           weights, status);
  if (!read) return status.issue();
  if (rows.size() != weights.size())
    return make_issue(IssueCode::asset_corrupt, "the columns of the prolongation differ in length",
                      group.where());
  std::vector<RowProlongation> prolongation(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) prolongation[r] = {rows[r], weights[r]};
  return prolongation;
}

Result<HierarchicalIndex> read_hierarchy(const GroupReader& group, const ComplianceHeader& header) {
  HierarchicalIndex index;
  const auto nodes = static_cast<std::uint64_t>(header.node_count);
  const auto leaves = static_cast<std::uint64_t>(header.block_count);
  // A block of |I| by |J| nodes has at most 3 min(|I|, |J|) terms: 3 n / 2 in every depth, of which a
  // body has fewer than 32.
  const std::uint64_t terms = 48 * nodes;
  Status status;
  (void)(take(group.integer(layout::depth), index.depth, status) &&
         take(read_rows<Index>(group, layout::order, nodes), index.order, status) &&
         take(read_rows<std::array<float, 6>>(group, layout::scale, nodes), index.scale, status) &&
         take(read_rows<float>(group, layout::leaf_step, leaves), index.leaf_step, status) &&
         take(read_rows<std::uint8_t>(group, layout::leaf_planes, leaves), index.leaf_planes, status) &&
         take(read_rows_if_any<Index>(group, layout::rank, leaves), index.rank, status) &&
         take(read_rows_if_any<float>(group, layout::step, leaves), index.step, status) &&
         take(read_rows_if_any<float>(group, layout::singular, terms), index.singular, status) &&
         take(read_rows_if_any<std::uint8_t>(group, layout::planes, terms), index.planes, status) &&
         take(read_rows<std::int64_t>(group, layout::record_begin, leaves + 1), index.record_begin,
              status));
  if (!status) return status.issue();
  return index;
}

bool has_shape_of(const DatasetReader& payload, const ComplianceHeader& header) {
  if (header.representation == ComplianceRepresentation::hierarchical)
    return payload.has_scalar(H5T_STD_U8LE) && payload.columns() == 0;
  const hid_t scalar = header.scalar == ScalarType::float32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  return payload.has_scalar(scalar) &&
         payload.rows() == static_cast<std::uint64_t>(header.block_count) &&
         payload.columns() == static_cast<std::uint64_t>(header.block_scalars);
}

}  // namespace

Result<ComplianceHeader> read_compliance_header(const GroupReader& group, std::string name) {
  ComplianceHeader header;
  header.name = std::move(name);
  Status status;
  const auto corrupt = IssueCode::asset_corrupt;
  const auto unknown = IssueCode::unsupported_representation;
  const bool read = take(read_choice<ComplianceRepresentation>(group, layout::representation,
                                                               layout::representations, unknown),
                         header.representation, status) &&
                    take(read_choice<ScalarType>(group, layout::scalar, layout::scalars, unknown),
                         header.scalar, status) &&
                    take(read_choice<ComplianceKind>(group, layout::kind, layout::kinds, corrupt),
                         header.kind, status) &&
                    take(group.text(layout::fixed_set), header.fixed_set, status) &&
                    take(group.real(layout::time_step), header.time_step_s, status) &&
                    take(group.real(layout::mass_factor), header.mass_factor, status) &&
                    take(group.real(layout::stiffness_factor), header.stiffness_factor, status) &&
                    take(group.real(layout::tolerance_asked), header.tolerance_asked, status) &&
                    take(group.real(layout::solve_residual), header.error.solve_residual, status) &&
                    take(group.real(layout::scaled_spectral), header.error.scaled_spectral, status) &&
                    take(group.real(layout::frobenius), header.error.frobenius, status) &&
                    take(group.real(layout::worst_column), header.error.worst_column, status) &&
                    take(group.integer(layout::node_count), header.node_count, status) &&
                    take(group.integer(layout::tile_nodes), header.tile_nodes, status) &&
                    take(group.integer(layout::block_count), header.block_count, status) &&
                    take(group.integer(layout::block_scalars), header.block_scalars, status);
  if (!read) return status.issue();
  if (Status added = read_attributes_of_1_2(group, header); !added) return added.issue();
  IssueList issues = first_issue_only();
  checks::check_compliance_header(header, group.where(), issues);
  return checked(std::move(header), issues);
}

namespace {

Result<ComplianceVariant> read_all_but_payload(const GroupReader& group, std::string name,
                                               const checks::MeshCounts& finest) {
  ComplianceVariant variant;
  Status status;
  (void)(take(read_compliance_header(group, std::move(name)), variant.header, status) &&
         take(read_rows<Index>(group, layout::nodes, finest.nodes), variant.nodes, status) &&
         take(read_prolongation(group, finest), variant.prolongation, status) &&
         (variant.header.representation != ComplianceRepresentation::hierarchical ||
          take(read_hierarchy(group, variant.header), variant.hierarchy, status)));
  if (!status) return status.issue();
  return variant;
}

}  // namespace

Result<DatasetReader> open_payload(const GroupReader& group, const ComplianceHeader& header) {
  Result<DatasetReader> dataset = group.dataset(layout::payload);
  if (dataset && !has_shape_of(*dataset, header))
    return make_issue(IssueCode::asset_corrupt, "the payload does not have the shape of its header",
                      group.where());
  return dataset;
}

Result<ComplianceSummary> read_compliance_summary(const GroupReader& group, std::string name) {
  ComplianceSummary summary;
  Status status;
  if (!take(read_compliance_header(group, std::move(name)), summary.header, status))
    return status.issue();
  const Result<DatasetReader> nodes = group.dataset(layout::nodes);
  if (!nodes) return nodes.issue();
  summary.surface_node_count = nodes->rows();
  if (summary.header.representation != ComplianceRepresentation::hierarchical) return summary;
  const auto leaves = static_cast<std::uint64_t>(summary.header.block_count);
  const bool read = take(group.integer(layout::depth), summary.depth, status) &&
                    take(read_rows_if_any<Index>(group, layout::rank, leaves), summary.rank, status) &&
                    take(read_rows<std::int64_t>(group, layout::record_begin, leaves + 1),
                         summary.record_begin, status);
  if (!read) return status.issue();
  const bool sound = summary.depth >= 0 && summary.depth < 32 && leaves == 1ULL << summary.depth &&
                     summary.rank.size() == leaves - 1 && summary.record_begin.size() == leaves + 1 &&
                     summary.record_begin[0] == 0 && std::ranges::is_sorted(summary.record_begin) &&
                     std::ranges::all_of(summary.rank, [](Index rank) { return rank >= 0; });
  if (!sound)
    return make_issue(IssueCode::asset_compliance_invalid, "the index contradicts itself",
                      group.where());
  return summary;
}

Result<ComplianceVariant> read_compliance_index(const GroupReader& group, std::string name,
                                                const checks::MeshCounts& finest) {
  Result<ComplianceVariant> variant = read_all_but_payload(group, std::move(name), finest);
  if (!variant) return variant;
  const Result<DatasetReader> payload = open_payload(group, variant->header);
  if (!payload) return payload.issue();
  IssueList issues = first_issue_only();
  checks::check_compliance_index(*variant, payload->raw_bytes(), finest.nodes, group.where(), issues);
  return checked(std::move(*variant), issues);
}

Result<ComplianceVariant> read_compliance(const GroupReader& group, std::string name,
                                          const checks::MeshCounts& finest) {
  Result<ComplianceVariant> variant = read_all_but_payload(group, std::move(name), finest);
  if (!variant) return variant;
  const Result<DatasetReader> payload = open_payload(group, variant->header);
  if (!payload) return payload.issue();
  Status status;
  if (!take(payload->read_all<std::byte>(payload->rows()), variant->payload, status))
    return status.issue();
  IssueList issues = first_issue_only();
  checks::check_compliance(*variant, finest.nodes, group.where(), issues);
  return checked(std::move(*variant), issues);
}

}  // namespace souple::storage
