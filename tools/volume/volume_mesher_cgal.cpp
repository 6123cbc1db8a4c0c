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
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_3.h>
#include <CGAL/Random.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/make_mesh_3.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <unordered_map>

#include "tools/geometry/vector.hpp"
#include "tools/volume/volume_mesher.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

/// Ends a refinement that goes round in circles, which it may near protected sharp edges: counts the
/// questions for sizes and intersections, not the time.
class Patience {
 public:
  void reset(std::size_t questions) { left_ = questions; }
  void ask() {
    if (left_ == 0) throw std::runtime_error("the mesher does not come to an end");
    --left_;
  }
  std::size_t left() const { return left_; }

 private:
  std::size_t left_ = 0;
};

/// The whole surface is one patch.
struct SurfaceDomain : CGAL::Polyhedral_mesh_domain_3<Surface, Kernel> {
  using Base = CGAL::Polyhedral_mesh_domain_3<Surface, Kernel>;
  SurfaceDomain(const Surface& surface, CGAL::Random* random, Patience* asked)
      : Base(surface, random),
        patch(make_surface_index({*faces(surface).begin(), &surface})),
        patience(asked) {}

  struct Construct_intersection {
    explicit Construct_intersection(const SurfaceDomain& domain)
        : base(domain), patience(domain.patience) {}
    template <class Query>
    Intersection operator()(const Query& query) const {
      patience->ask();
      return base(query);
    }
    Base::Construct_intersection base;
    Patience* patience;
  };
  Construct_intersection construct_intersection_object() const { return Construct_intersection(*this); }

  Surface_patch_index patch;
  Patience* patience;
};

using Domain = CGAL::Mesh_domain_with_polyline_features_3<SurfaceDomain>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, Kernel, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, int, int>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

constexpr unsigned random_seed = 20080;
/// Degrees; the mesher reaches it on every smooth shape tried, and stops trying there.
constexpr double sliver_bound = 12;
/// Refinement ends for sure with facet angles up to 30 degrees and radius-edge ratios from 2 on.
constexpr double facet_angle = 25;
constexpr double radius_edge_ratio = 2;

/// The limit of vertices is four times what is expected. Refinements that end ask up to 65 times for
/// each of their vertices.
constexpr std::size_t questions_per_vertex = 150;
/// Perturbing asks 13 to 145 times a vertex on sound shapes, 700 on a camel with slits; where sheets
/// nearly touch (self_intersectA.obj) it was still at it after a minute.
constexpr std::size_t perturb_questions_per_vertex = 1000, fewest_perturb_questions = 500'000;

/// A size as CGAL asks for it.
struct SizeField {
  using FT = Kernel::FT;
  using Point_3 = Kernel::Point_3;
  using Index = Domain::Index;
  FT operator()(const Point_3& p, int, const Index&) const {
    patience->ask();
    return (*length)({p.x(), p.y(), p.z()});
  }
  const MesherSizes::Field* length;
  Patience* patience;
};

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

double mean_edge_of(const Complex& complex) {
  double sum = 0;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell)
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) {
        const auto &p = cell->vertex(a)->point(), &q = cell->vertex(b)->point();
        sum += norm(Point{p.x() - q.x(), p.y() - q.y(), p.z() - q.z()});
      }
  return sum / (6 * std::max(1.0, static_cast<double>(complex.number_of_cells_in_complex())));
}

/// CGAL reports failures by exceptions, but talks of them on the standard error first.
void be_silent() {
  const auto silent = [](const char*, const char*, const char*, int, const char*) {};
  CGAL::set_error_handler(silent);
  CGAL::set_warning_handler(silent);
}

/// The protection of sharp edges warns on std::cerr without asking.
class SilentErrors {
 public:
  SilentErrors() : buffer_(std::cerr.rdbuf(nullptr)) {}
  ~SilentErrors() { std::cerr.rdbuf(buffer_); }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;

 private:
  std::streambuf* buffer_;
};

Issue failed(const char* what) { return make_issue(IssueCode::meshing_failed, what); }

Criteria criteria_of(const MesherSizes& sizes, Patience& patience) {
  namespace param = CGAL::parameters;
  return Criteria(param::edge_size = SizeField{&sizes.edge_length, &patience},
                  param::facet_angle = facet_angle,
                  param::facet_size = SizeField{&sizes.facet_radius, &patience},
                  param::facet_distance = SizeField{&sizes.facet_distance, &patience},
                  param::cell_radius_edge_ratio = radius_edge_ratio,
                  param::cell_size = SizeField{&sizes.cell_radius, &patience});
}

}  // namespace

struct VolumeMesher::Impl {
  Surface surface;
  CGAL::Random random{random_seed};
  Patience patience;
  Domain domain;
  std::vector<Point> seeds;
  bool has_features;
  Complex complex;

  Impl(const TriangleMesh& mesh, const MesherStart& start)
      : surface(to_cgal(mesh)),
        domain(surface, &random, &patience),
        seeds(start.seeds),
        has_features(!start.polylines.empty()) {
    std::vector<std::vector<Kernel::Point_3>> polylines;
    for (const auto& line : start.polylines) {
      auto& points = polylines.emplace_back();
      for (const Point& p : line) points.emplace_back(p[0], p[1], p[2]);
    }
    domain.add_features(polylines.begin(), polylines.end());
  }

  /// Seeds instead of CGAL's random ray hits, which can miss whole shells; none beside the balls that
  /// protect the sharp edges.
  void insert_seeds(const MesherSizes& sizes) {
    auto& triangulation = complex.triangulation();
    for (const Point& p : seeds) {
      const Kernel::Point_3 q(p[0], p[1], p[2]);
      if (has_features) {
        const auto nearest = triangulation.nearest_power_vertex(q);
        const auto& w = nearest->point();
        const double away = norm(Point{w.x() - p[0], w.y() - p[1], w.z() - p[2]});
        if (away < sizes.edge_length(p)) continue;
      }
      const auto vertex = triangulation.insert(Triangulation::Weighted_point(q));
      if (vertex == Triangulation::Vertex_handle()) continue;
      complex.set_dimension(vertex, 2);
      complex.set_index(vertex, domain.index_from_surface_patch_index(domain.patch));
    }
  }
};

VolumeMesher::VolumeMesher(const TriangleMesh& surface, const MesherStart& start)
    : impl_(std::make_unique<Impl>(surface, start)) {}
VolumeMesher::~VolumeMesher() = default;

Result<RefinedMesh> VolumeMesher::refine(const MesherSizes& sizes, std::size_t most_vertices) try {
  namespace param = CGAL::parameters;
  be_silent();
  CGAL::get_default_random() = CGAL::Random(random_seed);
  impl_->random = CGAL::Random(random_seed);
  impl_->complex.clear();
  CGAL::Mesh_error_code error = CGAL::CGAL_MESH_3_NO_ERROR;
  impl_->patience.reset(questions_per_vertex * most_vertices);
  const Criteria criteria = criteria_of(sizes, impl_->patience);
  if (impl_->has_features) {
    const SilentErrors silent;
    CGAL::Mesh_3::internal::init_c3t3_with_features(impl_->complex, impl_->domain, criteria, false,
                                                    most_vertices, &error);
  }
  impl_->insert_seeds(sizes);
  if (error == CGAL::CGAL_MESH_3_NO_ERROR)
    CGAL::refine_mesh_3(impl_->complex, impl_->domain, criteria, param::no_perturb(), param::no_exude(),
                        param::no_reset_c3t3(), param::manifold(),
                        param::mesh_3_options(param::maximal_number_of_vertices = most_vertices,
                                              param::pointer_to_error_code = &error));
  if (error != CGAL::CGAL_MESH_3_NO_ERROR)
    return failed("the refinement did not end within its limit of vertices");
  return RefinedMesh{static_cast<std::size_t>(impl_->complex.number_of_cells_in_complex()),
                     mean_edge_of(impl_->complex)};
} catch (const std::exception& e) {
  return failed(e.what());
}

Result<TetMesh> VolumeMesher::optimise() try {
  namespace param = CGAL::parameters;
  impl_->patience.reset(
      std::max(fewest_perturb_questions,
               perturb_questions_per_vertex * impl_->complex.triangulation().number_of_vertices()));
  CGAL::perturb_mesh_3(impl_->complex, impl_->domain, param::time_limit = 0,
                       param::sliver_bound = sliver_bound);
  CGAL::exude_mesh_3(impl_->complex, param::time_limit = 0, param::sliver_bound = sliver_bound);
  return to_plain(impl_->complex);
} catch (const std::exception& e) {
  return failed(e.what());
}

}  // namespace souple
