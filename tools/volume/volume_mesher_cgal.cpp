// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

// Mesh_3 writes dump-bug.* files into the working folder when the refinement fails. The failure is
// caught here and becomes an issue; this stands in for CGAL/Mesh_3/Dump_c3t3.h, so that nothing is left
// behind.
#define CGAL_MESH_3_DUMP_C3T3_H
namespace CGAL {
template <class Complex>
void dump_c3t3(const Complex&, const std::string&) {}
template <class Complex>
void dump_c3t3_edges(const Complex&, const std::string&) {}
}  // namespace CGAL

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_3.h>
#include <CGAL/Random.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/make_mesh_3.h>

#include <exception>
#include <unordered_map>

#include "tools/volume/volume_mesher.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using PlainDomain = CGAL::Polyhedral_mesh_domain_3<Surface, Kernel>;

/// Starts the refinement at given points instead of random ray hits, which can miss whole shells.
struct Domain : PlainDomain {
  Domain(const Surface& surface, const std::vector<Point>& points, CGAL::Random* random)
      : PlainDomain(surface, random) {
    const Index index =
        index_from_surface_patch_index(make_surface_index({*faces(surface).begin(), &surface}));
    for (const Point& p : points) seeds.emplace_back(Point_3(p[0], p[1], p[2]), index);
  }
  struct Construct_initial_points {
    const Domain& domain;
    template <class Output>
    Output operator()(Output out, int = 0) const {
      return std::copy(domain.seeds.begin(), domain.seeds.end(), out);
    }
  };
  Construct_initial_points construct_initial_points_object() const { return {*this}; }
  std::vector<std::pair<Point_3, Index>> seeds;
};

using Triangulation = CGAL::Mesh_triangulation_3<Domain, Kernel, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

constexpr unsigned random_seed = 20080;
/// Degrees; the mesher reaches it on every shape tried, and stops trying there.
constexpr double sliver_bound = 12;
/// Refinement ends for sure with facet angles up to 30 degrees and radius-edge ratios from 2 on.
constexpr double facet_angle = 25;
constexpr double radius_edge_ratio = 2;

Surface to_cgal(const TriangleMesh& mesh) {
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  for (const Point& p : mesh.vertices) vertices.push_back(surface.add_vertex({p[0], p[1], p[2]}));
  for (const Triangle& t : mesh.triangles)
    surface.add_face(vertices[static_cast<std::size_t>(t[0])], vertices[static_cast<std::size_t>(t[1])],
                     vertices[static_cast<std::size_t>(t[2])]);
  return surface;
}

TetMesh to_plain(const Complex& complex) {
  TetMesh mesh;
  std::unordered_map<const void*, Index> numbers;
  const auto number = [&](Complex::Vertex_handle v) {
    const auto [found, is_new] = numbers.try_emplace(&*v, static_cast<Index>(mesh.nodes.size()));
    if (is_new) mesh.nodes.push_back({v->point().x(), v->point().y(), v->point().z()});
    return found->second;
  };
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    Tet& tet = mesh.tets.emplace_back();
    for (int k = 0; k < 4; ++k) tet[static_cast<std::size_t>(k)] = number(cell->vertex(k));
  }
  return mesh;
}

Issue failed(const char* what) { return make_issue(IssueCode::meshing_failed, what); }

}  // namespace

struct VolumeMesher::Impl {
  Surface surface;
  CGAL::Random random{random_seed};
  Domain domain;
  Complex complex;
  Impl(const TriangleMesh& mesh, const std::vector<Point>& seeds)
      : surface(to_cgal(mesh)), domain(surface, seeds, &random) {}
};

VolumeMesher::VolumeMesher(const TriangleMesh& surface, const std::vector<Point>& seeds)
    : impl_(std::make_unique<Impl>(surface, seeds)) {}
VolumeMesher::~VolumeMesher() = default;

Result<std::size_t> VolumeMesher::refine(const MesherSizes& sizes, std::size_t most_vertices) try {
  namespace param = CGAL::parameters;
  CGAL::get_default_random() = CGAL::Random(random_seed);
  impl_->random = CGAL::Random(random_seed);
  CGAL::Mesh_error_code error = CGAL::CGAL_MESH_3_NO_ERROR;
  const Criteria criteria(param::facet_angle = facet_angle, param::facet_size = sizes.facet_radius,
                          param::facet_distance = sizes.facet_distance,
                          param::cell_radius_edge_ratio = radius_edge_ratio,
                          param::cell_size = sizes.cell_radius);
  impl_->complex = CGAL::make_mesh_3<Complex>(
      impl_->domain, criteria, param::no_perturb(), param::no_exude(), param::manifold(),
      param::mesh_3_options(param::maximal_number_of_vertices = most_vertices,
                            param::pointer_to_error_code = &error));
  if (error != CGAL::CGAL_MESH_3_NO_ERROR)
    return failed("the refinement did not end within its limit of vertices");
  return static_cast<std::size_t>(impl_->complex.number_of_cells_in_complex());
} catch (const std::exception& e) {
  return failed(e.what());
}

Result<TetMesh> VolumeMesher::optimise() try {
  namespace param = CGAL::parameters;
  CGAL::perturb_mesh_3(impl_->complex, impl_->domain, param::time_limit = 0,
                       param::sliver_bound = sliver_bound);
  CGAL::exude_mesh_3(impl_->complex, param::time_limit = 0, param::sliver_bound = 0);
  return to_plain(impl_->complex);
} catch (const std::exception& e) {
  return failed(e.what());
}

}  // namespace souple
