#include "integrators/portals.h"

#include "scene/scene.h"

namespace rayleaf {

Ray behind_portal(const Scene& scene, const Vertex& vertex, MediumStack& media) {
    /// World units, squared, as in Cycles: up to here the ray leaves the vertex's own surface.
    constexpr double kSamePlace = 1e-9;
    const Portal& portal = vertex.closures.portal;
    const Vec3d position(portal.position), direction = ray_direction(portal.direction);
    Ray ray;
    if ((position - vertex.point.position).length2() <= kSamePlace) {
        vertex.point.release(ray, direction);
        leave_towards(scene, vertex.point, vertex.outgoing, portal.direction, media);
        return ray;
    }
    ray.origin = position;
    ray.direction = direction;
    ray.time = vertex.point.time;
    if (scene.has_media()) media = media_around(scene, position, ray.time);
    return ray;
}

}  // namespace rayleaf
