#include "integrators/ambient_occlusion.h"

#include "integrators/scattered_differential.h"
#include "integrators/shadow.h"
#include "shading/lobe_frame.h"

#include <array>
#include <vector>

namespace rayleaf {

Color ambient_occlusion(const Scene& scene, const PathSettings& settings, const Vertex& vertex,
                        const OcclusionRays& rays) {
    const Vec3f normal = facing_normal(vertex);
    Vec3f tangent, bitangent;
    orthonormal_basis(normal, tangent, bitangent);
    PathState state;
    state.camera = false;
    state.diffuse = state.reflection = true;
    state.depth = state.diffuse_depth = 1;
    Color sum(0.0f);
    std::vector<FreeWay> ways;
    const auto add_ways = [&] {
        std::array<Color, kPacketSize> shares;
        free_shares(scene, ways, Coherence::Incoherent, shares.data());
        for (size_t i = 0; i < ways.size(); ++i) sum += shares[i];
        ways.clear();
    };
    for (int i = 0; i < rays.count; ++i) {
        const Vec2f random =
            rays.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(rays.count), rays.dimension)
                .get2(rays.dimension);
        const Vec3f local = cosine_hemisphere(random.x, random.y);
        const Vec3f direction = tangent * local.x + bitangent * local.y + normal * local.z;
        // A shading normal bent from the facet has part of its hemisphere inside the surface.
        if (direction.dot(vertex.point.facet_normal) * vertex.outgoing.dot(vertex.point.facet_normal) <= 0.0f) continue;
        Ray ray;
        vertex.point.release(ray, ray_direction(direction));
        ray.t_max = settings.occlusion_distance;
        const RayDifferential differential =
            hemisphere_differential(vertex.differential, direction, local.z, std::max(rays.count, kPathSiblings));
        ways.push_back(
            {ray, differential, kVisibleDiffuse, state, settings.transparent_bounces, rays.widening, {}, {}});
        if (ways.size() == kPacketSize) add_ways();
    }
    add_ways();
    return sum / static_cast<float>(rays.count);
}

}  // namespace rayleaf
