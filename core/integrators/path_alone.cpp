// One path after the other, ray by ray: the slow twin of path_stream.
#include "integrators/path_tracer.h"
#include "integrators/shadow.h"

namespace rayleaf {

PixelSample PathTracer::trace() {
    ClosestHit found;
    if (sees_) follow(arrive_alone(found), found);
    return finish();
}

Arrival PathTracer::arrive_alone(ClosestHit& found) {
    const RayQuery query = next_ray();
    found = scene_.tracer().closest(*query.ray, query.kind, query.differential);
    std::vector<LightRay> light_rays;
    const Arrival arrival = arrive(found, light_rays);
    receive_alone(light_rays);
    return arrival;
}

/// Traces the rays to lights, takes the light that arrives, and forgets the rays.
void PathTracer::receive_alone(std::vector<LightRay>& light_rays) {
    for (const LightRay& light : light_rays) receive(light, free_share(scene_, light));
    light_rays.clear();
}

void PathTracer::follow(Arrival arrival, ClosestHit& found) {
    std::vector<LightRay> light_rays;
    for (;; arrival = arrive_alone(found)) {
        if (arrival == Arrival::AtSurface && meets_catcher()) {
            PathTracer alone = split();
            ClosestHit found_alone;
            alone.follow(arrival, found_alone);
            take_footage(alone.finish());
        }
        const bool goes_on = arrival == Arrival::GoesOn || (arrival == Arrival::AtSurface && shade_alone(light_rays)) ||
                             (arrival == Arrival::InWorld && see_world_alone());
        receive_alone(light_rays);
        if (!goes_on) return;
    }
}

bool PathTracer::shade_alone(std::vector<LightRay>& light_rays) {
    Vertex vertex;
    vertex.point = scene_.tracer().surface_point(ray_, *hit_);
    material_->surface->evaluate(approach(vertex), vertex.closures);
    simplify(vertex.closures);
    std::vector<LightQuery> lights;
    if (!look(vertex, random2(PathDimension::Light), lights)) return false;
    for (LightQuery& query : lights)
        query.light = scene_.lights().sample(*query.at, query.random, query.time, query.path);
    return leave(vertex, random2(PathDimension::Scatter), lights, light_rays);
}

bool PathTracer::see_world_alone() {
    Closures closures;
    scene_.world_program()->evaluate(look_at_world(closures), closures);
    take_world(closures.emission);
    return false;
}

PixelSample trace_path(const Scene& scene, const PathSettings& settings, const CameraRay& camera_ray,
                       const Sampler& sampler, RayCounts& counts, SampleExtras* extras) {
    PathTracer path(scene, settings, camera_ray, sampler, counts);
    if (extras) path.write_extras(*extras);
    return path.trace();
}

}  // namespace rayleaf
