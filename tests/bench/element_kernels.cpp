// SPDX-License-Identifier: GPL-3.0-or-later
// Element kernels of a liver of 10k tets, one core, thread time: rotations by several methods, the
// terms of a step, assembly, and products with the matrix, each beside what was tried against it.
#include <Eigen/SVD>
#include <cmath>
#include <cstring>
#include <random>

#include "runtime/fem/polar_rotation.hpp"
#include "tests/bench/assembly_trials.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/machine_peaks.hpp"
#include "tests/bench/rotation_trials.hpp"
#include "tests/bench/row.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

constexpr double poisson = 0.4;
constexpr double lambda_over_mu = 2 * poisson / (1 - 2 * poisson);
constexpr double mass_factor = 1e4 + 10, stiffness_factor = 2;

TetMesh liver_mesh(std::size_t tets) {
  ImportOptions import;
  import.size_m = 0.2;
  const auto imported =
      value_or_exit(import_surface(data_folder() / "surfaces/liver-smooth.obj", import));
  const TriangleMesh surface = value_or_exit(orient_closed_surface(imported.mesh)).mesh;
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  return value_or_exit(tetrahedralize(surface, options)).mesh;
}

/// Twisted by `twist` rad/m about x, squashed along z, and moved by noise of so many metres.
Eigen::VectorXd deformed(const TetMesh& mesh, double twist, double squash, double noise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, noise);
  Eigen::VectorXd x(3 * Eigen::Index(mesh.nodes.size()));
  for (Index n = 0; n < Index(mesh.nodes.size()); ++n) {
    const Point& p = mesh.nodes[std::size_t(n)];
    node_entry(x, n) =
        Eigen::AngleAxisd(twist * p[0], Vec3::UnitX()) * Vec3(p[0], p[1], squash * p[2]) +
        Vec3(normal(random), normal(random), normal(random));
  }
  return x;
}

std::vector<Mat3> gradients_of(const TetMesh& mesh, const Eigen::VectorXd& x) {
  std::vector<Mat3> result;
  for (const Tet& tet : mesh.tets) {
    Mat3 now, rest;
    for (std::size_t k = 0; k < 3; ++k) {
      now.col(Eigen::Index(k)) = node_entry(x, tet[k + 1]) - node_entry(x, tet[0]);
      rest.col(Eigen::Index(k)) =
          as_vec3(mesh.nodes[std::size_t(tet[k + 1])]) - as_vec3(mesh.nodes[std::size_t(tet[0])]);
    }
    result.push_back(now * rest.inverse());
  }
  return result;
}

Mat3 svd_rotation(const Mat3& f) {
  const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

/// Where the rotation is unique by less than this, relative to the largest stretch, it is not compared.
constexpr double least_uniqueness = 1e-4;

bool is_unique(const Mat3& f) {
  const Eigen::JacobiSVD<Mat3> svd(f);
  const double sign = f.determinant() < 0 ? -1 : 1;
  return svd.singularValues()[1] + sign * svd.singularValues()[2] >
         least_uniqueness * svd.singularValues()[0];
}

/// Angle of the rotation between two, or 3 if one of them is not a rotation at all.
double angle(const Mat3& a, const Mat3& b) {
  const double sine = (a - b).norm() / std::sqrt(8.0);
  return std::isfinite(sine) && sine <= 1 ? 2 * std::asin(sine) : 3;
}

template <class T>
ResultHash hash_of(const T* data, std::size_t count) {
  ResultHash hash;
  hash.add(std::span<const T>(data, count));
  return hash;
}
ResultHash hash_of(const std::vector<Mat3>& m) { return hash_of(m.front().data(), 9 * m.size()); }

template <class Work>
double row_time(const std::string& name, const ResultHash& hash, Work&& work) {
  std::vector<double> seconds;
  for (int run = 0; run < 7; ++run) seconds.push_back(least_seconds(30, work));
  print_row("elements." + name, "us", seconds, hash, 1e6);
  return *std::min_element(seconds.begin(), seconds.end());
}

class RotationRows {
 public:
  RotationRows(const std::string& state, const TetMesh& mesh, const CorotationalModel& model,
               const Eigen::VectorXd& x)
      : state_(state), model_(model), x_(x), gradients_(gradients_of(mesh, x)) {
    for (const Mat3& f : gradients_) {
      exact_.push_back(polar_rotation(f));
      unique_.push_back(is_unique(f));
      inverted_ += f.determinant() <= 0;
    }
  }

  void print() {
    std::vector<Mat3> found;
    print_row("elements." + state_ + ".inverted", "1", double(inverted_), hash_of(gradients_));
    const double polar = by_model("polar", RotationMethod::polar);
    by_model("qr", RotationMethod::qr);
    by_model("gram_schmidt", RotationMethod::gram_schmidt);
    found.resize(gradients_.size());
    const double svd = timed("jacobi_svd", found, [&] {
      for (std::size_t t = 0; t < found.size(); ++t) found[t] = svd_rotation(gradients_[t]);
    });
    timed("newton_one_by_one", found, [&] {
      for (std::size_t t = 0; t < found.size(); ++t) found[t] = polar_rotation(gradients_[t]);
    });
    print_row("elements." + state_ + ".polar_faster_than_jacobi_svd", "x", svd / polar, hash_of(found));
    print_trials();
  }

 private:
  double by_model(const std::string& name, RotationMethod method) {
    std::vector<Mat3> found;
    return timed(name, found, [&] { model_.element_rotations(x_, found, method); });
  }

  template <class Work>
  double timed(const std::string& name, std::vector<Mat3>& found, Work&& work) {
    work();
    const double seconds = row_time(state_ + "." + name, hash_of(found), work);
    print_error(name, found);
    return seconds;
  }

  void print_error(const std::string& name, const std::vector<Mat3>& found) const {
    double largest = 0;
    for (std::size_t t = 0; t < found.size(); ++t)
      if (unique_[t]) largest = std::max(largest, angle(found[t], exact_[t]));
    print_row("elements." + state_ + "." + name + ".error", "rad", largest, hash_of(found));
  }

  template <class Scalar, class Work>
  void trial(const std::string& name, std::vector<Scalar>& r, Work&& work) {
    work();
    row_time(state_ + ".trial." + name, hash_of(r.data(), r.size()), work);
    const std::size_t n = r.size() / 9;
    std::vector<Mat3> found(gradients_.size());
    for (std::size_t t = 0; t < found.size(); ++t)
      for (std::size_t k = 0; k < 9; ++k)
        found[t](Eigen::Index(k / 3), Eigen::Index(k % 3)) = double(r[k * n + t]);
    print_error("trial." + name, found);
  }

  /// Quaternions of rotations 3 degrees from the exact ones: those of a last step.
  Eigen::Quaterniond last(std::size_t t) const {
    const Vec3 axis = Vec3(std::sin(double(t)), std::cos(double(t)), 0.5).normalized();
    return Eigen::Quaterniond(Eigen::AngleAxisd(3 * std::acos(-1.0) / 180, axis) * exact_[t]);
  }

  template <class Scalar>
  void arrays(std::vector<Scalar>& f, std::vector<Scalar>& q) const {
    const std::size_t n = (gradients_.size() + 7) / 8 * 8;
    f.resize(9 * n);
    q.resize(4 * n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t t = std::min(i, gradients_.size() - 1);
      for (std::size_t k = 0; k < 9; ++k)
        f[k * n + i] = Scalar(gradients_[t](Eigen::Index(k / 3), Eigen::Index(k % 3)));
      const Eigen::Quaterniond before = last(t);
      q[i] = Scalar(before.w());
      for (std::size_t k = 0; k < 3; ++k) q[(k + 1) * n + i] = Scalar(before.vec()[Eigen::Index(k)]);
    }
  }

  // From arrays to arrays: what gathering and the form of the results cost is left out.
  void print_trials() {
    std::vector<float> f, q, next, r;
    arrays(f, q);
    next.resize(q.size());
    r.resize(f.size());
    const auto in_floats = [&]<class Method>(const std::string& name, Method) {
      trial(name, r, [&] { rotate_all<Method>(f, q, next, r); });
    };
    in_floats("newton_float_5", HighamNewton<5>{});
    in_floats("newton_float_8", HighamNewton<8>{});
    in_floats("mueller_float_2", QuaternionSteps<2>{});
    in_floats("mueller_float_5", QuaternionSteps<5>{});
    in_floats("quaternion_newton_float_2", QuaternionNewton<2>{});
    std::vector<double> fd, qd, next_d, rd;
    arrays(fd, qd);
    next_d.resize(qd.size());
    rd.resize(fd.size());
    const auto in_doubles = [&]<class Method>(const std::string& name, Method) {
      trial(name, rd, [&] { rotate_all<Method>(fd, qd, next_d, rd); });
    };
    in_doubles("newton_double_6", HighamNewton<6>{});
    in_doubles("quaternion_newton_double_2", QuaternionNewton<2>{});
    in_doubles("quaternion_newton_double_3", QuaternionNewton<3>{});
    trial("shipped_double", rd, [&] { shipped_all(fd, rd); });
  }

  std::string state_;
  const CorotationalModel& model_;
  const Eigen::VectorXd& x_;
  std::vector<Mat3> gradients_, exact_;
  std::vector<char> unique_;
  std::size_t inverted_ = 0;
};

void print_step_rows(const CorotationalModel& model, const Eigen::VectorXd& x) {
  std::vector<Mat3> rotations, nodes;
  CornerVectors gradients = model.make_corner_vectors(), corner_forces = gradients;
  BlockMatrix a(model.pattern()), other(model.pattern());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size());
  const auto evaluate = [&] {
    model.evaluate_elements(x, RotationMethod::polar, rotations, gradients, corner_forces);
  };
  const auto assemble = [&] { model.assemble(mass_factor, stiffness_factor, gradients, a); };
  const auto add_forces = [&] {
    f.setZero();
    model.add_corner_forces(corner_forces, f);
  };
  evaluate();
  assemble();
  add_forces();
  const ResultHash of_matrix = hash_of(a.values.data(), a.values.size());
  row_time("step.rotations_gradients_forces", hash_of(rotations), evaluate);
  row_time("step.nodal_forces", hash_of(f.data(), std::size_t(f.size())), add_forces);
  row_time("step.assembly", of_matrix, assemble);
  row_time("step.all", of_matrix, [&] {
    evaluate();
    add_forces();
    assemble();
  });
  model.node_rotations(rotations, nodes);
  row_time("step.node_rotations", hash_of(nodes), [&] { model.node_rotations(rotations, nodes); });
  CornerVectors scratch = gradients;
  row_time("step.forces_alone", hash_of(f.data(), std::size_t(f.size())),
           [&] { model.add_elastic_forces(x, rotations, scratch, f); });

  const ScatteredAssembly scattered(model, lambda_over_mu);
  RowAssembly by_rows(model, lambda_over_mu);
  row_time("assembly.trial.by_element", of_matrix,
           [&] { scattered.assemble(mass_factor, stiffness_factor, gradients, other); });
  const auto difference = [&] {
    double largest = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
      largest = std::max(largest, std::abs(a.values[i] - other.values[i]));
    return largest / *std::max_element(a.values.begin(), a.values.end());
  };
  const double by_element = difference();
  row_time("assembly.trial.by_row", of_matrix,
           [&] { by_rows.assemble(mass_factor, stiffness_factor, gradients, other); });
  print_row("elements.assembly.largest_difference", "1", std::max(by_element, difference()), of_matrix);
}

template <class Scalar>
double matrix_bytes(const BasicBlockMatrix<Scalar>& a) {
  return double(a.values.size() * sizeof(Scalar) + a.pattern->column.size() * sizeof(Index));
}

void print_product_rows(const std::string& size, const CorotationalModel& model) {
  BlockMatrix a(model.pattern());
  model.assemble_rest(mass_factor, stiffness_factor, a);
  BlockMatrixF single(model.pattern());
  std::ranges::copy(a.values, single.values.begin());
  Eigen::VectorXd x = Eigen::VectorXd::Random(3 * Eigen::Index{model.node_count()}), y = x;
  Eigen::VectorXf x_single = x.cast<float>(), y_single = x_single;
  multiply(a, x, y);
  multiply(single, x_single, y_single);
  const ResultHash hash = hash_of(y.data(), std::size_t(y.size()));
  const ResultHash hash_single = hash_of(y_single.data(), std::size_t(y_single.size()));
  const std::string name = "product." + size + ".";
  print_row("elements." + name + "nodes", "1", double(model.node_count()), hash);
  const double in_double = row_time(name + "double", hash, [&] { multiply(a, x, y); });
  const double in_single =
      row_time(name + "float", hash_single, [&] { multiply(single, x_single, y_single); });
  row_time(name + "trial.half", hash, [&] { multiply_half(a, x.data(), y.data()); });
  const double peak = triad_bytes_per_s(std::size_t(matrix_bytes(a)));
  const double peak_single = triad_bytes_per_s(std::size_t(matrix_bytes(single)));
  print_row("elements." + name + "double.rate", "GB/s", 1e-9 * matrix_bytes(a) / in_double, hash);
  print_row("elements." + name + "double.triad", "GB/s", 1e-9 * peak, hash);
  print_row("elements." + name + "float.rate", "GB/s", 1e-9 * matrix_bytes(single) / in_single,
            hash_single);
  print_row("elements." + name + "float.triad", "GB/s", 1e-9 * peak_single, hash_single);
}

CorotationalModel model_of(const TetMesh& mesh) {
  return value_or_exit(
      CorotationalModel::create(mesh, test::material_of(1e4, poisson, 1000, 0.1, 0.01)));
}

}  // namespace
}  // namespace souple::bench

int main() {
  using namespace souple;
  using namespace souple::bench;
  const TetMesh mesh = liver_mesh(10'000);
  const CorotationalModel model = model_of(mesh);
  print_row("elements.tets", "1", double(model.tet_count()), ResultHash{});
  const Eigen::VectorXd bent = deformed(mesh, 8, 0.9, 3e-4), crushed = deformed(mesh, 8, 0.05, 1e-3);
  RotationRows("bent", mesh, model, bent).print();
  RotationRows("crushed", mesh, model, crushed).print();
  print_step_rows(model, bent);
  print_product_rows("10k", model);
  print_product_rows("60k", model_of(liver_mesh(60'000)));
}
