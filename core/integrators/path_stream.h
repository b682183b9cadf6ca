// Many paths at once, stage by stage: their rays are traced in packets; then the surfaces that they met are shaded, all
// of one material together; then each path makes of its vertex what it makes of it alone (path_tracer.h); then the rays
// to the lights that were chosen are traced.
//
// A path's arithmetic does not depend on the others in the stream, so neither the stream's size nor the order of paths
// shows in a picture. Streams are small enough that a thread's own cache holds them (Áfra, Benthin, Wald, Munkberg
// 2016, "Local Shading Coherence Extraction for SIMD-Efficient Path Tracing on CPUs").
#pragma once

#include "base/cancel.h"
#include "integrators/material_bins.h"
#include "integrators/path_tracer.h"
#include "shading/scatter_lanes.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

class PathStream {
  public:
    /// There is room for `most` paths. Tracing throws Cancelled soon after `cancel` says so.
    PathStream(const Scene& scene, const PathSettings& settings, size_t most, const CancelToken& cancel);

    /// `counts` gets the path's rays.
    void add(const CameraRay& ray, const Sampler& sampler, RayCounts& counts);
    size_t size() const { return paths_.size(); }
    /// Traces the paths that were added and forgets them; calls `take` with what each contributes, in the order in
    /// which they were added.
    template <typename Take>
    void trace(const Take& take) {
        trace_all();
        for (const Split& split : splits_) paths_[split.path].take_footage(paths_[split.alone].finish());
        for (size_t i = 0; i + splits_.size() < paths_.size(); ++i) take(paths_[i].finish());
        paths_.clear();
        splits_.clear();
    }

  private:
    const Scene& scene_;
    const PathSettings& settings_;
    const CancelToken& cancel_;
    std::vector<PathTracer> paths_;
    std::vector<SampleExtras> extras_;  ///< by path, where the settings ask for some
    std::vector<uint32_t> active_;      ///< paths that go on
    std::vector<ClosestHit> found_;     ///< by their rays
    std::vector<LightRay> light_rays_;  ///< that the paths wait for
    MaterialBins bins_;                 ///< paths that met a surface
    std::vector<uint32_t> in_world_;    ///< paths that ask what the world shows
    std::vector<uint8_t> goes_on_;      ///< by path
    /// A path that met a shadow catcher, and the same in the footage alone; these are the last of the paths.
    struct Split {
        uint32_t path, alone;
    };
    std::vector<Split> splits_;
    std::vector<Vertex> vertices_;  ///< of the paths that are shaded together
    std::vector<ShadingInputs> inputs_;
    std::vector<ScatterQuery> scatter_queries_;
    std::vector<LightQuery> light_queries_;
    /// A vertex that waits for lights and for what lanes tell of its closures.
    struct Waiting {
        uint32_t number;
        size_t lights;  ///< of the queries, as many are its own
    };
    std::vector<Waiting> waiting_;

    void trace_all();
    void trace_active(Coherence coherence);
    Arrival arrive(uint32_t path, ClosestHit& found);
    void add_to_bins(uint32_t path);
    void split_at_catchers();
    void see_world();
    void shade(const Program& program, std::span<const uint32_t> paths);
    void go_on(std::span<const uint32_t> paths, std::span<Vertex> vertices, std::span<const VertexNumbers> numbers);
    void leave(uint32_t path, Vertex& vertex, const Vec2f& random, std::span<LightQuery> lights);
    void foresee(std::span<const uint32_t> paths, std::span<Vertex> vertices, std::span<const VertexNumbers> numbers);
    void keep_those_that_go_on();
    void trace_light_rays(Coherence coherence);
    void trace_light_packet(std::span<LightRay> lights, Coherence coherence);
};

}  // namespace rayleaf
