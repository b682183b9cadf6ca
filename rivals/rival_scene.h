// Other ways to trace smooth surfaces: the baseline of the ray cache in benchmarks, used by nothing else.
//
// All surfaces of a scene in one Embree scene, single precision, exact bicubic normals at the hits:
//   triangles: 16 x 16 cells a patch, in Embree's own triangles; one ray or packets of 16;
//   Newton: the exact patches as user geometry, 4 x 4 boxes a patch. A ray is the intersection of two planes, and
//   Newton's iteration starts in the middle of the box (Martin, Cohen, Fish, Shirley, "Practical Ray Tracing of Trimmed
//   NURBS Surfaces", JGT 2000).
// Surfaces are polynomial, of degree three at most in either direction.
#pragma once

#include "geometry/patch_surface.h"
#include "rays/packet.h"
#include "trace/bicubic.h"
#include "trace/embree.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

enum class RivalMethod : uint8_t { Triangles, Newton };

/// Newton: iterations before a box counts as missed, and how near the surface must be to the ray, scene units.
inline constexpr int kMostNewtonSteps = 8;
inline constexpr float kNewtonTolerance = 1e-6f;
/// Newton: boxes along one side of a patch, and how far the parameters may leave the box they started in.
inline constexpr int kNewtonBoxes = 4;
inline constexpr float kNewtonSlack = 0.25f;

/// Scene space: that of the surfaces, moved and scaled to about [-1, 1].
struct RivalRay {
    Vec3f origin{0, 0, 0}, direction{0, 0, 1};  ///< unit
    float t_min = 0.0f;
};

struct RivalHit {
    float t = 0;
    uint32_t surface = 0;
    Vec3f position{0, 0, 0};        ///< on the exact surface
    Vec3f normal{0, 0, 1};          ///< unit, exact, on the side of the winding
    Vec3f facet_position{0, 0, 0};  ///< where rays go on
    Vec3f facet_normal{0, 0, 1};    ///< unit, same side
};

/// A triangle as Embree found it.
struct FoundTriangle {
    float t = 0, u = 0, v = 0;    ///< distance; weights of the second and the third corner
    uint32_t triangle = 0;        ///< 512 a patch, numbered as those of a grid (tessellation/grid.h)
    Vec3f facet_normal{0, 0, 0};  ///< neither unit nor on a certain side
};

class RivalScene {
  public:
    /// Throws InputError for a surface that is rational or of a higher degree.
    RivalScene(std::span<const std::shared_ptr<const PatchSurface>> surfaces, RivalMethod method);

    const LocalFrame& frame() const { return frame_; }
    RivalMethod method() const { return method_; }
    const std::vector<BicubicPatch>& patches() const { return patches_; }
    /// Newton: 16 boxes a patch.
    const std::vector<Box3f>& part_boxes() const { return boxes_; }

    /// The nearest hit beyond t_min; false without one. The ray must be finite.
    bool closest(const RivalRay& ray, RivalHit& hit) const;
    /// Sixteen at once: those where `active` is not 0. `active` becomes 0 for rays that hit nothing. Triangles only.
    void closest16(const std::array<RivalRay, kPacketSize>& rays, std::array<int, kPacketSize>& active,
                   std::array<RivalHit, kPacketSize>& hits) const;
    RivalHit on_patch(uint32_t patch, const BicubicPoint& point, float t) const;
    RivalHit on_triangle(const RivalRay& ray, const FoundTriangle& found) const;
    /// Embree's tree, facets and patches.
    uint64_t bytes() const { return bytes_; }

  private:
    LocalFrame frame_;
    RivalMethod method_;
    std::vector<BicubicPatch> patches_;
    std::vector<uint32_t> surface_of_;  ///< by patch
    std::vector<Box3f> boxes_;          ///< Newton: of the parts, by patch
    EmbreeScene scene_;
    uint64_t bytes_ = 0;

    void add_patches(const PatchSurface& surface, uint32_t index);
    RTCGeometry triangles() const;
    RTCGeometry newton_boxes();

    static void bounds_callback(const RTCBoundsFunctionArguments* arguments);
    static void newton_callback(const RTCIntersectFunctionNArguments* arguments);
};

/// Vertex (i, j) of 17 x 17 of a patch.
Vec3f grid_vertex(const BicubicPatch& patch, int i, int j);

/// The two planes that a ray is the intersection of.
struct RayPlanes {
    Vec3f normal1{1, 0, 0}, normal2{0, 1, 0};
    float offset1 = 0, offset2 = 0;
    explicit RayPlanes(const RivalRay& ray);
};

/// Newton's iteration from the middle of a part of a patch: its parameters and point on the ray.
struct NewtonHit {
    float u = 0, v = 0, t = 0;
    int steps = 0;       ///< evaluations made
    bool found = false;  ///< inside the patch and beyond t_min
    BicubicPoint point;  ///< of a hit
};
NewtonHit newton_hit(const BicubicPatch& patch, int part, const RivalRay& ray, const RayPlanes& planes);

}  // namespace rayleaf
