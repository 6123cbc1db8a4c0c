// SPDX-License-Identifier: MIT
// The numbers of the C interface are those of the runtime's enumerators: checked here, by the compiler.
#include "formats/core/asset.hpp"
#include "formats/core/issue.hpp"
#include "runtime/c_api/souple/souple.h"
#include "runtime/world/constraints.hpp"
#include "runtime/world/contact_events.hpp"
#include "runtime/world/loads.hpp"
#include "runtime/world/settings.hpp"

namespace souple {
namespace {

template <class Enum>
constexpr bool same(int number, Enum enumerator) {
  return number == static_cast<int>(enumerator);
}

static_assert(same(SOUPLE_API_ARGUMENT_MISSING, IssueCode::api_argument_missing));
static_assert(same(SOUPLE_API_ARGUMENT_INVALID, IssueCode::api_argument_invalid));
static_assert(same(SOUPLE_API_STRUCT_SIZE_INVALID, IssueCode::api_struct_size_invalid));
static_assert(same(SOUPLE_API_BUFFER_TOO_SMALL, IssueCode::api_buffer_too_small));
static_assert(same(SOUPLE_API_VERSION_MISMATCH, IssueCode::api_version_mismatch));
static_assert(same(SOUPLE_API_NO_SUCH_OBJECT, IssueCode::api_no_such_object));
static_assert(same(SOUPLE_IO_FILE_MISSING, IssueCode::io_file_missing));
static_assert(same(SOUPLE_IO_CANNOT_READ, IssueCode::io_cannot_read));
static_assert(same(SOUPLE_IO_OUT_OF_MEMORY, IssueCode::io_out_of_memory));
static_assert(same(SOUPLE_ASSET_NOT_AN_ASSET, IssueCode::asset_not_an_asset));
static_assert(same(SOUPLE_ASSET_CORRUPT, IssueCode::asset_corrupt));
static_assert(same(SOUPLE_ASSET_MISSING_PART, IssueCode::asset_missing_part));
static_assert(same(SOUPLE_FIXED_SET_INVALID, IssueCode::fixed_set_invalid));
static_assert(same(SOUPLE_WORLD_PARAMETER_INVALID, IssueCode::world_parameter_invalid));
static_assert(same(SOUPLE_NO_MATCHING_COMPLIANCE, IssueCode::scene_no_matching_compliance));
static_assert(same(SOUPLE_LOAD_INVALID, IssueCode::load_invalid));
static_assert(same(SOUPLE_DRIVEN_NODES_INVALID, IssueCode::driven_nodes_invalid));
static_assert(same(SOUPLE_RIGID_MESH_INVALID, IssueCode::rigid_mesh_invalid));
static_assert(same(SOUPLE_STEP_NOT_FINITE, IssueCode::step_not_finite));
static_assert(same(SOUPLE_COMPLIANCE_NOT_LOADED, IssueCode::compliance_not_loaded));
static_assert(same(SOUPLE_SNAPSHOT_INVALID, IssueCode::snapshot_invalid));
static_assert(same(SOUPLE_JOINT_INVALID, IssueCode::joint_invalid));
static_assert(same(SOUPLE_SOLVER_NOT_CONVERGED, IssueCode::solver_not_converged));
static_assert(same(SOUPLE_INTERNAL_ERROR, IssueCode::internal_error));
static_assert(same(SOUPLE_UNSUPPORTED_VERSION, IssueCode::unsupported_version));
static_assert(same(SOUPLE_UNSUPPORTED_FEATURE, IssueCode::unsupported_feature));

static_assert(same(SOUPLE_COMPLIANCE_DYNAMIC_STEP, ComplianceKind::dynamic_step));
static_assert(same(SOUPLE_COMPLIANCE_STATIC_EQUILIBRIUM, ComplianceKind::static_equilibrium));

static_assert(same(SOUPLE_INTEGRATOR_IMPLICIT_EULER, Integrator::implicit_euler));
static_assert(same(SOUPLE_INTEGRATOR_BDF2, Integrator::bdf2));
static_assert(same(SOUPLE_INTEGRATOR_QUASI_STATIC, Integrator::quasi_static));
static_assert(same(SOUPLE_INTEGRATOR_EXPLICIT_EULER, Integrator::explicit_euler));

static_assert(same(SOUPLE_CONTACT_WARPED, ContactMethod::warped));
static_assert(same(SOUPLE_CONTACT_EXACT, ContactMethod::exact));
static_assert(same(SOUPLE_CONTACT_PENALTY, ContactMethod::penalty));

static_assert(same(SOUPLE_ROTATION_POLAR, RotationMethod::polar));
static_assert(same(SOUPLE_ROTATION_QR, RotationMethod::qr));
static_assert(same(SOUPLE_ROTATION_GRAM_SCHMIDT, RotationMethod::gram_schmidt));

static_assert(same(SOUPLE_SOLVER_AUTOMATIC, SolverKind::automatic));
static_assert(same(SOUPLE_SOLVER_JACOBI_PCG, SolverKind::jacobi_pcg));
static_assert(same(SOUPLE_SOLVER_GAUSS_SEIDEL_PCG, SolverKind::gauss_seidel_pcg));
static_assert(same(SOUPLE_SOLVER_MULTIGRID, SolverKind::multigrid));
static_assert(same(SOUPLE_SOLVER_MULTIGRID_PCG, SolverKind::multigrid_pcg));
static_assert(same(SOUPLE_SOLVER_DIRECT, SolverKind::direct));
static_assert(same(SOUPLE_SOLVER_WARPED_PCG, SolverKind::warped_pcg));
static_assert(same(SOUPLE_SOLVER_WARPED_MULTIGRID_PCG, SolverKind::warped_multigrid_pcg));

static_assert(same(SOUPLE_UNCONVERGED_KEEP_BEST, UnconvergedStep::keep_best));
static_assert(same(SOUPLE_UNCONVERGED_REFUSE, UnconvergedStep::refuse));

static_assert(same(SOUPLE_SHAPE_PLANE, RigidShapeKind::plane));
static_assert(same(SOUPLE_SHAPE_SPHERE, RigidShapeKind::sphere));
static_assert(same(SOUPLE_SHAPE_BOX, RigidShapeKind::box));
static_assert(same(SOUPLE_SHAPE_CAPSULE, RigidShapeKind::capsule));
static_assert(same(SOUPLE_SHAPE_MESH, RigidShapeKind::mesh));

static_assert(same(SOUPLE_LOAD_NODE_FORCE, LoadKind::node_force));
static_assert(same(SOUPLE_LOAD_POINT_FORCE, LoadKind::point_force));
static_assert(same(SOUPLE_LOAD_TRACTION, LoadKind::traction));
static_assert(same(SOUPLE_LOAD_PRESSURE, LoadKind::pressure));

static_assert(same(SOUPLE_JOINT_BALL, JointKind::ball));
static_assert(same(SOUPLE_JOINT_HINGE, JointKind::hinge));
static_assert(same(SOUPLE_JOINT_WELD, JointKind::weld));

static_assert(same(SOUPLE_EVENT_BEGIN, ContactEventKind::begin));
static_assert(same(SOUPLE_EVENT_PERSIST, ContactEventKind::persist));
static_assert(same(SOUPLE_EVENT_END, ContactEventKind::end));

static_assert(SOUPLE_SOLVER_WARPED_MULTIGRID_PCG + 1 == solver_names.size());

}  // namespace
}  // namespace souple
