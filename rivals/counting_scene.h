// The counting twin of a rival's scene: a plain binary tree over the same boxes that counts floating-point operations.
//
// Operations inside Embree cannot be counted. This tree is built by the surface area heuristic over the same triangles,
// or the same parts of patches, and traces the same rays. Additions, subtractions, multiplications, divisions and
// square roots count; comparisons, minima and maxima do not. Embree's own nodes are wider and test boxes that a binary
// tree does not: it performs more operations than are counted here, many at once.
#pragma once

#include "rivals/rival_scene.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

/// Operations by kernel.
inline constexpr int kRaySetupFlops = 3;                 ///< the inverse of the direction
inline constexpr int kBoxFlops = 12;                     ///< six distances to planes
inline constexpr int kTriangleFlops = 52;                ///< Moeller and Trumbore's test
inline constexpr int kPlanesFlops = 25;                  ///< a ray as two planes, once a ray
inline constexpr int kNewtonFlops = kBicubicFlops + 45;  ///< evaluation, two distances, four slopes, solution
inline constexpr int kNormalFlops =
    kBicubicFlops + 19;  ///< at a triangle's hit: evaluation, cross product, unit length
inline constexpr int kNewtonNormalFlops = 19;

class CountingScene {
  public:
    explicit CountingScene(const RivalScene& scene);

    /// Like RivalScene::closest; adds the operations of the query.
    bool closest(const RivalRay& ray, RivalHit& hit, uint64_t& flops) const;

  private:
    struct Node {
        Box3f box;
        uint32_t first = 0;  ///< child, the other one follows; or first of the order
        uint32_t count = 0;  ///< of primitives; 0 for inner nodes
    };
    struct Build;

    const RivalScene* scene_;
    std::vector<std::array<Vec3f, 3>> triangles_;
    std::vector<Node> nodes_;
    std::vector<uint32_t> order_;

    void add_triangles();
    bool test(uint32_t primitive, const RivalRay& ray, const RayPlanes& planes, float& t_max, RivalHit& hit,
              uint64_t& flops) const;
};

}  // namespace rayleaf
