// What may answer rays against one shape in place of tracing them. Ray caches (ri_tree/) lie above the tracer, which
// knows them by this interface alone.
//
// All in the local space of the shape.
#pragma once

#include "rays/hit.h"
#include "rays/ray_differential.h"

namespace rayleaf {

/// How far the neighbours of a ray in this picture lie from it at the object; zeros: as close as can be.
struct RayNeighbours {
    float distance = 0;  ///< local units
    float angle = 0;     ///< radians
    /// How the ray changes with the picture's x and y; null: changes of the answer are not needed.
    const RayDifferential* differential = nullptr;
};

struct ObjectAnswer {
    RayAnswer answer = RayAnswer::Traced;  ///< Traced: the caller has to
    double distance = 0;                   ///< to the first hit, from the origin
    uint32_t primitive = 0;                ///< an element of the material that was hit
    Vec3d normal{0, 0, 1};                 ///< unit, of the surface there, on the side of the winding
    InterpolatedHit hit;
};

/// The length of a line inside a shape.
struct LengthAnswer {
    RayAnswer answer = RayAnswer::Traced;
    double length = 0;
    float error = 0;  ///< as InterpolatedHit has it
};

/// Thread-safe; answers are pure functions of the arguments.
class LocalRayCache {
  public:
    /// `number` is what the pass Rayleaf Tree shows.
    explicit LocalRayCache(uint32_t number) : number_(number) {}
    virtual ~LocalRayCache() = default;
    LocalRayCache(const LocalRayCache&) = delete;
    LocalRayCache& operator=(const LocalRayCache&) = delete;

    /// The first hit beyond `origin` along the unit `direction`.
    virtual ObjectAnswer ask(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours) const = 0;
    /// How much of the ray lies inside.
    virtual LengthAnswer ask_length(const Vec3d& origin, const Vec3d& direction,
                                    const RayNeighbours& neighbours) const = 0;
    uint32_t number() const { return number_; }

  private:
    uint32_t number_;
};

}  // namespace rayleaf
