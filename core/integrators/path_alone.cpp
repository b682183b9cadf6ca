// One path after the other, ray by ray: the slow twin of path_stream.
#include "integrators/path_tracer.h"
#include "integrators/shadow.h"

namespace rayleaf {

PixelSample PathTracer::trace() {
    if (sees_) follow(arrive_alone());
    return finish();
}

Arrival PathTracer::arrive_alone() {
    const RayQuery query = next_ray();
    return arrive(scene_.tracer().closest(*query.ray, query.kind, query.differential));
}

void PathTracer::follow(Arrival arrival) {
    std::vector<LightRay> light_rays;
    for (;; arrival = arrive_alone()) {
        light_rays.clear();
        if (arrival == Arrival::AtSurface && meets_catcher()) {
            PathTracer alone = split();
            alone.follow(arrival);
            take_footage(alone.finish());
        }
        const bool goes_on = arrival == Arrival::GoesOn || (arrival == Arrival::AtSurface && shade_alone(light_rays)) ||
                             (arrival == Arrival::InWorld && see_world_alone());
        for (const LightRay& light : light_rays) receive(light, free_share(scene_, light));
        if (!goes_on) return;
    }
}

bool PathTracer::shade_alone(std::vector<LightRay>& light_rays) {
    Vertex vertex;
    vertex.point = scene_.tracer().surface_point(ray_, *hit_);
    scene_.material(hit_->instance, hit_->local).surface->evaluate(approach(vertex), vertex.closures);
    return shade(vertex, {random2(PathDimension::Light), random2(PathDimension::Scatter)}, light_rays);
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
