#include "integrators/path_stream.h"

#include "integrators/shadow.h"

#include <array>
#include <new>
#include <type_traits>

namespace rayleaf {
namespace {

template <typename T, typename Visit>
void for_each_part(std::span<T> all, size_t most, const Visit& visit) {
    for (size_t first = 0; first < all.size(); first += most)
        visit(all.subspan(first, std::min(most, all.size() - first)));
}

/// Puts what `make` returns at its place. Copied there it would wait for its parts, which have just been written.
template <typename T, typename Make>
void put(T& place, const Make& make) {
    static_assert(std::is_trivially_destructible_v<T>);
    new (&place) T(make());
}

/// Vertices that are lit and left together: as many as fill the lanes of vectors, and few enough that the nearest cache
/// holds them.
constexpr size_t kMostGoingOn = 16;

template <typename T, typename Visit>
void for_each_packet(std::span<T> all, const Visit& visit) {
    for_each_part(all, kPacketSize, visit);
}

}  // namespace

PathStream::PathStream(const Scene& scene, const PathSettings& settings, size_t most, const CancelToken& cancel)
    : scene_(scene),
      settings_(settings),
      cancel_(cancel),
      vertices_(kMostPoints),
      inputs_(kMostPoints),
      scatter_queries_(kMostGoingOn) {
    paths_.reserve(most);
    light_rays_.reserve(most);
}

void PathStream::add(const CameraRay& ray, const Sampler& sampler, RayCounts& counts) {
    paths_.emplace_back(scene_, settings_, ray, sampler, counts);
}

void PathStream::trace_all() {
    active_.resize(paths_.size());
    for (uint32_t i = 0; i < active_.size(); ++i) active_[i] = i;
    std::erase_if(active_, [this](uint32_t path) { return !paths_[path].sees(); });
    if (settings_.has_extras()) {
        extras_.resize(std::max(extras_.size(), paths_.size()));
        for (size_t i = 0; i < paths_.size(); ++i) paths_[i].write_extras(extras_[i]);
    }
    // Rays of the camera, and from what it sees to one light, run alike.
    Coherence coherence = Coherence::Coherent;
    while (!active_.empty()) {
        trace_active(coherence);
        trace_light_rays(coherence);
        if (settings_.catches_shadows) split_at_catchers();
        see_world();
        bins_.for_each([this](const Program& program, std::span<const uint32_t> paths) { shade(program, paths); });
        keep_those_that_go_on();
        trace_light_rays(coherence);
        coherence = Coherence::Incoherent;
    }
}

/// One ray of each path that goes on.
void PathStream::trace_active(Coherence coherence) {
    bins_.clear();
    in_world_.clear();
    goes_on_.assign(paths_.size(), 0);
    found_.resize(std::max(found_.size(), active_.size()));
    std::array<RayQuery, kPacketSize> queries;
    ClosestHit* found = found_.data();
    for_each_packet(std::span<const uint32_t>(active_), [&](std::span<const uint32_t> paths) {
        cancel_.throw_if_cancelled();
        for (size_t i = 0; i < paths.size(); ++i) put(queries[i], [&] { return paths_[paths[i]].next_ray(); });
        scene_.tracer().closest({queries.data(), paths.size()}, coherence, found);
        for (size_t i = 0; i < paths.size(); ++i) {
            PathTracer& path = paths_[paths[i]];
            const Arrival arrival = arrive(paths[i], found[i]);
            goes_on_[paths[i]] = arrival == Arrival::GoesOn ? 1 : 0;
            if (arrival == Arrival::InWorld) in_world_.push_back(paths[i]);
            if (arrival == Arrival::AtSurface) add_to_bins(paths[i]);
            if (arrival == Arrival::AtSurface && path.meets_catcher()) splits_.push_back({paths[i], 0});
        }
        found += paths.size();
    });
}

Arrival PathStream::arrive(uint32_t path, ClosestHit& found) {
    const size_t wanted = light_rays_.size();
    const Arrival arrival = paths_[path].arrive(found, light_rays_);
    for (size_t i = wanted; i < light_rays_.size(); ++i) light_rays_[i].path = path;
    return arrival;
}

void PathStream::add_to_bins(uint32_t path) {
    bins_.add(*paths_[path].material().surface, path);
}

void PathStream::split_at_catchers() {
    for (Split& split : splits_) {
        if (split.alone != 0) continue;
        split.alone = static_cast<uint32_t>(paths_.size());
        paths_.push_back(paths_[split.path].split());
        active_.push_back(split.alone);
        add_to_bins(split.alone);
    }
    goes_on_.resize(paths_.size(), 0);
}

void PathStream::see_world() {
    std::array<const ShadingInputs*, kMostPoints> of_point;
    std::array<Closures*, kMostPoints> closures;
    for_each_part(std::span<const uint32_t>(in_world_), kMostPoints, [&](std::span<const uint32_t> paths) {
        for (size_t i = 0; i < paths.size(); ++i) {
            closures[i] = &vertices_[i].closures;
            put(inputs_[i], [&] { return paths_[paths[i]].look_at_world(*closures[i]); });
            of_point[i] = &inputs_[i];
        }
        scene_.world_program()->evaluate({of_point.data(), paths.size()}, {closures.data(), paths.size()});
        for (size_t i = 0; i < paths.size(); ++i) paths_[paths[i]].take_world(closures[i]->emission);
    });
}

static_assert(kMostPoints * PathTracer::kPairsOfVertex <= SamplePairs::kMost);

/// Paths that met surfaces of one material.
void PathStream::shade(const Program& program, std::span<const uint32_t> all) {
    std::array<const ShadingInputs*, kMostPoints> of_point;
    std::array<Closures*, kMostPoints> closures;
    std::array<SurfaceQuery, kMostPoints> surfaces;
    const SurfaceDetail detail = scene_.needs_footprints() ? SurfaceDetail::Curvature : SurfaceDetail::Normal;
    for (size_t first = 0; first < all.size(); first += kMostPoints) {
        const std::span<const uint32_t> paths = all.subspan(first, std::min(kMostPoints, all.size() - first));
        for (size_t i = 0; i < paths.size(); ++i) {
            const PathTracer& path = paths_[paths[i]];
            surfaces[i] = {&path.ray(), &path.hit(), &vertices_[i].point};
        }
        scene_.tracer().surface_points({surfaces.data(), paths.size()}, detail);
        for (size_t i = 0; i < paths.size(); ++i) {
            Vertex& vertex = vertices_[i];
            put(inputs_[i], [&] { return paths_[paths[i]].approach(vertex); });
            of_point[i] = &inputs_[i];
            closures[i] = &vertex.closures;
        }
        program.evaluate({of_point.data(), paths.size()}, {closures.data(), paths.size()});
        SamplePairs pairs;
        for (const uint32_t path : paths) paths_[path].ask_numbers(pairs);
        pairs.compute();
        std::array<VertexNumbers, kMostPoints> numbers;
        for (size_t i = 0; i < paths.size(); ++i) {
            numbers[i] = PathTracer::numbers(pairs, i * PathTracer::kPairsOfVertex);
            paths_[paths[i]].simplify(vertices_[i].closures);
        }
        for_each_part(paths, kMostGoingOn, [&](std::span<const uint32_t> part) {
            const auto i = static_cast<size_t>(part.data() - paths.data());
            go_on(part, {vertices_.data() + i, part.size()}, {numbers.data() + i, part.size()});
        });
    }
}

/// By lights and scattered rays, from vertices whose closures are known.
void PathStream::go_on(std::span<const uint32_t> paths, std::span<Vertex> vertices,
                       std::span<const VertexNumbers> numbers) {
    light_queries_.clear();
    waiting_.clear();
    for (uint32_t i = 0; i < paths.size(); ++i) {
        const size_t first = light_queries_.size();
        const bool stays = paths_[paths[i]].look(vertices[i], numbers[i].light, light_queries_);
        vertices[i].is_foreseen = false;
        goes_on_[paths[i]] = 0;
        if (stays && vertices[i].closures.has_smooth_lobes())
            waiting_.push_back({i, light_queries_.size() - first});
        else if (stays)
            leave(paths[i], vertices[i], numbers[i].scatter, {});
    }
    if (waiting_.empty()) return;
    scene_.lights().sample(light_queries_);
    foresee(paths, vertices, numbers);
    LightQuery* lights = light_queries_.data();
    for (const Waiting& each : waiting_) {
        leave(paths[each.number], vertices[each.number], numbers[each.number].scatter, {lights, each.lights});
        lights += each.lights;
    }
}

void PathStream::leave(uint32_t path, Vertex& vertex, const Vec2f& random, std::span<LightQuery> lights) {
    const size_t wanted = light_rays_.size();
    goes_on_[path] = paths_[path].leave(vertex, random, lights, light_rays_) ? 1 : 0;
    for (size_t i = wanted; i < light_rays_.size(); ++i) light_rays_[i].path = path;
}

/// What lights and scattered rays ask of the closures of vertices that wait for them.
void PathStream::foresee(std::span<const uint32_t> paths, std::span<Vertex> vertices,
                         std::span<const VertexNumbers> numbers) {
    const std::span<ScatterQuery> queries(scatter_queries_.data(), waiting_.size());
    const LightQuery* lights = light_queries_.data();
    for (size_t i = 0; i < queries.size(); ++i) {
        const Waiting& each = waiting_[i];
        Vertex& vertex = vertices[each.number];
        ScatterQuery& query = queries[i];
        query.closures = &vertex.closures;
        query.outgoing = vertex.outgoing;
        query.facet_normal = vertex.point.facet_normal;
        query.random = numbers[each.number].scatter;
        query.view = &vertex.view;
        query.sample = &vertex.scattered;
        query.lit = &vertex.lit_by_lights;
        query.lights = {};
        query.answered = false;
        if (each.lights > 0) query.light_side = side_normal(vertex);
        for (size_t k = 0; k < each.lights; ++k, ++lights)
            if (lights->light && !paths_[paths[each.number]].asks_kinds(*lights->light))
                query.lights[k] = &lights->light->direction;
    }
    sample_together(queries);
    for (size_t i = 0; i < queries.size(); ++i) vertices[waiting_[i].number].is_foreseen = queries[i].answered;
}

void PathStream::keep_those_that_go_on() {
    std::erase_if(active_, [this](uint32_t path) { return goes_on_[path] == 0; });
}

void PathStream::trace_light_rays(Coherence coherence) {
    for_each_packet(std::span(light_rays_), [&](std::span<LightRay> lights) { trace_light_packet(lights, coherence); });
    light_rays_.clear();
}

void PathStream::trace_light_packet(std::span<LightRay> lights, Coherence coherence) {
    std::array<FreeWay*, kPacketSize> ways;
    std::array<Color, kPacketSize> free;
    for (size_t i = 0; i < lights.size(); ++i) ways[i] = &lights[i];
    free_shares_of_packet(scene_, {ways.data(), lights.size()}, coherence, free.data());
    for (size_t i = 0; i < lights.size(); ++i) paths_[lights[i].path].receive(lights[i], free[i]);
}

}  // namespace rayleaf
