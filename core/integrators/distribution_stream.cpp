#include "integrators/distribution_stream.h"

#include <array>

namespace rayleaf {
namespace {

template <typename Item, typename Visit>
void for_each_part_of(std::span<Item> items, size_t most, const Visit& visit) {
    for (size_t first = 0; first < items.size(); first += most)
        visit(items.subspan(first, std::min(most, items.size() - first)));
}

}  // namespace

DistributionStream::DistributionStream(const DistributionFrame& frame, const CancelToken& cancel)
    : frame_(frame), cancel_(cancel), vertices_(kMostPoints) {}

void DistributionStream::add(const CameraRay& ray, const Sampler& sampler, RayCounts& counts) {
    if (trees_.size() == size_) trees_.emplace_back(frame_, counts);
    DistributionTracer& tree = trees_[size_++];
    tree.count_in(counts);
    tree.begin(ray, sampler);
}

void DistributionStream::trace_all() {
    if (frame_.settings.path.has_extras()) {
        extras_.resize(std::max(extras_.size(), size_));
        for (size_t i = 0; i < size_; ++i) trees_[i].write_extras(extras_[i]);
    }
    active_.clear();
    for (uint32_t i = 0; i < size_; ++i)
        if (trees_[i].goes_on()) active_.push_back(i);
    // As in PathStream.
    Coherence coherence = Coherence::Coherent;
    while (!active_.empty()) {
        trace_active(coherence);
        bins_.for_each([this](const Program& program, std::span<const uint32_t> trees) { shade(program, trees); });
        trace_waiting(
            coherence, [](DistributionTracer& tree) { return tree.light_ways(); },
            [](DistributionTracer& tree, const Color* free) { tree.receive_light(free); });
        trace_waiting(
            Coherence::Incoherent, [](DistributionTracer& tree) { return tree.world_ways(); },
            [](DistributionTracer& tree, const Color* free) { tree.receive_world(free); });
        std::erase_if(active_, [this](uint32_t tree) { return !trees_[tree].goes_on(); });
        coherence = Coherence::Incoherent;
    }
}

/// One ray of each tree that goes on.
void DistributionStream::trace_active(Coherence coherence) {
    bins_.clear();
    std::array<RayQuery, kPacketSize> queries;
    std::array<ClosestHit, kPacketSize> found;
    for_each_part_of(std::span<const uint32_t>(active_), kPacketSize, [&](std::span<const uint32_t> trees) {
        cancel_.throw_if_cancelled();
        for (size_t i = 0; i < trees.size(); ++i) queries[i] = trees_[trees[i]].next_ray();
        frame_.scene.tracer().closest({queries.data(), trees.size()}, coherence, found.data());
        for (size_t i = 0; i < trees.size(); ++i) {
            DistributionTracer& tree = trees_[trees[i]];
            if (!tree.arrive(std::move(found[i]))) continue;
            bins_.add(*frame_.scene.material(tree.hit().instance, tree.hit().local).surface, trees[i]);
        }
    });
}

/// Trees the rays of which met surfaces of one material.
void DistributionStream::shade(const Program& program, std::span<const uint32_t> all) {
    std::array<ShadingInputs, kMostPoints> inputs;
    std::array<const ShadingInputs*, kMostPoints> of_point;
    std::array<Closures*, kMostPoints> closures;
    std::array<SurfaceQuery, kMostPoints> surfaces;
    const Scene& scene = frame_.scene;
    const SurfaceDetail detail = scene.needs_footprints() ? SurfaceDetail::Curvature : SurfaceDetail::Normal;
    for_each_part_of(all, kMostPoints, [&](std::span<const uint32_t> trees) {
        for (size_t i = 0; i < trees.size(); ++i) {
            const DistributionTracer& tree = trees_[trees[i]];
            surfaces[i] = {&tree.ray(), &tree.hit(), &vertices_[i].point};
        }
        scene.tracer().surface_points({surfaces.data(), trees.size()}, detail);
        for (size_t i = 0; i < trees.size(); ++i) {
            Vertex& vertex = vertices_[i];
            inputs[i] = trees_[trees[i]].approach(vertex);
            of_point[i] = &inputs[i];
            closures[i] = &vertex.closures;
        }
        program.evaluate({of_point.data(), trees.size()}, {closures.data(), trees.size()});
        for (size_t i = 0; i < trees.size(); ++i) trees_[trees[i]].shade(vertices_[i]);
    });
}

template <typename Ways, typename Receive>
void DistributionStream::trace_waiting(Coherence coherence, const Ways& ways_of, const Receive& receive) {
    waiting_.clear();
    for (const uint32_t tree : active_)
        for (FreeWay& way : ways_of(trees_[tree])) waiting_.push_back(&way);
    free_.resize(waiting_.size());
    Color* free = free_.data();
    for_each_part_of(std::span<FreeWay* const>(waiting_), kPacketSize, [&](std::span<FreeWay* const> ways) {
        free_shares_of_packet(frame_.scene, ways, coherence, free);
        free += ways.size();
    });
    free = free_.data();
    for (const uint32_t tree : active_) {
        const size_t count = ways_of(trees_[tree]).size();
        receive(trees_[tree], free);
        free += count;
    }
}

}  // namespace rayleaf
