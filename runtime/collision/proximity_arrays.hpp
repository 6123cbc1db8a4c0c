// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/collision/feature_minima.hpp"
#include "runtime/collision/local_minima.hpp"
#include "runtime/collision/proximity_work.hpp"
#include "runtime/collision/swept_pairs.hpp"

namespace souple {

struct TreeNodePair {
  Index a = 0, b = 0;
};

/// Entries that are all forgotten at once: an entry counts only if its stamp is the present one.
template <class T>
class StampedTable {
 public:
  void clear(std::size_t size) {
    if (stamps_.size() < size) {
      stamps_.resize(size, 0);
      values_.resize(size);
    }
    if (++now_ == 0) {
      stamps_.assign(stamps_.size(), 0);
      now_ = 1;
    }
  }
  bool has(Index k) const { return stamps_[k] == now_; }
  T& operator[](Index k) { return values_[k]; }
  /// Returns whether it is new.
  bool set(Index k, const T& value) {
    const bool is_new = !has(k);
    stamps_[k] = now_;
    values_[k] = value;
    return is_new;
  }

 private:
  std::vector<std::uint32_t> stamps_;
  std::vector<T> values_;
  std::uint32_t now_ = 0;
};

struct NormalCone {
  Eigen::Vector3f axis = Eigen::Vector3f::UnitZ();
  float half_angle = 0;
};

/// A vertex of one surface near a feature of the other.
struct VertexHit {
  Index vertex = 0;
  PointMinimum minimum;
};

/// Ridges of one surface that were looked at, kept side by side.
struct RidgeTable {
  StampedTable<Index> slot;  ///< of an edge: into `ridges`, or -1 if it is none
  std::vector<Ridge> ridges;
};

struct ProximityWork::Arrays {
  std::vector<TreeNodePair> stack;
  std::vector<TreeNodePair> leaves;        ///< pairs of leaves that are near
  std::vector<FloatBox> boxes_a, boxes_b;  ///< of swept surfaces
  std::vector<FloatBox> normals;           ///< bounds of the normals below every tree node
  std::vector<FloatBox> vertex_normals;    ///< of the normals of the faces at every vertex
  std::vector<Eigen::Vector3f> face_normals;
  std::vector<NormalCone> cones;  ///< of the normals of every leaf
  std::vector<VertexHit> hits;
  std::vector<PointMinimum> near;  ///< of one vertex
  std::vector<Index> open;         ///< vertices to look at, a stack
  StampedTable<char> seen;         ///< vertices that have been looked at
  StampedTable<char> touched;      ///< connected parts that have hits
  std::array<RidgeTable, 2> ridges;
  std::array<std::vector<Index>, 2> piercing;  ///< edges that pass through the other surface
  std::vector<SweptPair> swept;
  std::vector<LocalMinimum> minima;
};

}  // namespace souple
