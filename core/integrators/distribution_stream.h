// The trees of many camera rays at once, stage by stage: of each tree one ray is under way, as it would be alone. Rays
// are traced in packets, surfaces of one material are shaded together, and then the rays that wait for their way.
//
// As in path_stream.h neither the stream's size nor the order of trees shows in a picture.
#pragma once

#include "base/cancel.h"
#include "integrators/distribution_tracer.h"
#include "integrators/material_bins.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

class DistributionStream {
  public:
    /// What as many trees hold fits a thread's own cache: each has a packet of rays that wait.
    static constexpr size_t kMost = 64;

    /// Tracing throws Cancelled soon after `cancel` says so.
    DistributionStream(const DistributionFrame& frame, const CancelToken& cancel);

    /// `counts` gets the tree's rays.
    void add(const CameraRay& ray, const Sampler& sampler, RayCounts& counts);
    size_t size() const { return size_; }
    /// Traces what was added and forgets it; calls `take` with what each camera ray contributes, in the order in which
    /// they were added.
    template <typename Take>
    void trace(const Take& take) {
        trace_all();
        for (size_t i = 0; i < size_; ++i) take(trees_[i].finish());
        size_ = 0;
    }

  private:
    const DistributionFrame& frame_;
    const CancelToken& cancel_;
    size_t size_ = 0;
    std::vector<DistributionTracer> trees_;  ///< the first `size_` of them; the others keep their memory
    std::vector<SampleExtras> extras_;       ///< by tree, where the settings ask for some
    std::vector<uint32_t> active_;           ///< trees that go on
    MaterialBins bins_;                      ///< trees the rays of which met a surface
    std::vector<Vertex> vertices_;           ///< that are shaded together
    std::vector<FreeWay*> waiting_;          ///< rays of the trees that go on, tree by tree
    std::vector<Color> free_;                ///< what gets through along their ways

    void trace_all();
    void trace_active(Coherence coherence);
    void shade(const Program& program, std::span<const uint32_t> trees);
    /// `ways_of` and `receive` of all trees that go on.
    template <typename Ways, typename Receive>
    void trace_waiting(Coherence coherence, const Ways& ways_of, const Receive& receive);
};

}  // namespace rayleaf
