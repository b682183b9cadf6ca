// Distribution ray tracing into bodies that light goes through: as many walks as rays go over a hemisphere, each goes
// on from where it leaves as a matte surface does, with its share of rays.
#include "integrators/distribution_tracer.h"
#include "integrators/subsurface_walk.h"

namespace rayleaf {

void DistributionTracer::scatter_below(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes) {
    if (lobes.subsurface().size() == 0) return;
    const int count = rays(branch, distribution_.hemisphere_rays);
    const uint32_t use = dimension(branch.vertex, PathDimension::Below);
    for (int i = 0; i < count; ++i) {
        Branch child = branch;
        child.sampler = branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        child.throughput /= static_cast<float>(count);
        child.share /= static_cast<float>(count);
        const std::optional<LobeSample> entry =
            lobes.subsurface().sample(vertex.outgoing, vertex.point.facet_normal, child.sampler.get3(use));
        if (entry) walk_on(std::move(child), vertex, *entry);
    }
}

void DistributionTracer::walk_on(Branch branch, const Vertex& vertex, const LobeSample& entry) {
    const std::optional<SubsurfaceVertex> exit = leave_below(
        scene_, {vertex, entry, branch.bounces.at(0), branch.sampler, dimension(branch.vertex, PathDimension::Below)});
    if (!exit) return;
    branch.throughput *= exit->throughput;
    branch.shows_features = false;
    ++branch.vertex;
    if (!survives(branch, settings_)) return;
    if (branch.spread == Spread::One) {
        sample_light_once(branch, exit->vertex);
        return scatter_once(branch, Hit(), exit->vertex, 0.0f);  // no cache has answered it
    }
    const SplitClosures lobes(exit->vertex.closures, exit->vertex.outgoing, exit->vertex.point.facet_normal);
    sample_lights(branch, exit->vertex, lobes);
    scatter_over_hemisphere(branch, exit->vertex, lobes);
}

}  // namespace rayleaf
