#include "python/packets.h"

#include "python/arrays.h"
#include "python/ray_footprints.h"
#include "trace/tracer.h"

#include <array>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

Coherence coherence(bool coherent) {
    return coherent ? Coherence::Coherent : Coherence::Incoherent;
}

/// Calls `ask` with the number of each packet's first ray and its queries.
template <typename Ask>
void in_packets(const RayArrays& arrays, const Ask& ask) {
    const size_t count = arrays.size();
    tbb::parallel_for(size_t{0}, (count + kPacketSize - 1) / kPacketSize, [&](size_t packet) {
        const size_t first = packet * kPacketSize, size = std::min<size_t>(kPacketSize, count - first);
        std::array<Ray, kPacketSize> rays;
        std::array<RayQuery, kPacketSize> queries;
        for (size_t i = 0; i < size; ++i) {
            rays[i] = arrays[first + i];
            queries[i] = {&rays[i], kVisibleAll, nullptr};
        }
        ask(first, std::span<const RayQuery>(queries.data(), size));
    });
}

py::dict closest_in_packets(const Tracer& tracer, const Array<double>& origins, const Array<double>& directions,
                            bool coherent, const Array<float>& times, const Array<uint32_t>& starts) {
    RayArrays rays =
        ray_arrays(origins, directions, number(0.0), number(std::numeric_limits<double>::infinity()), times);
    rays.starts = starts;
    rays.check();
    const size_t count = rays.size();
    py::array_t<double> t(count), position(std::vector<size_t>{count, 3});
    py::array_t<int32_t> instance(count), primitive(count);
    double *t_out = t.mutable_data(), *position_out = position.mutable_data();
    int32_t *instance_out = instance.mutable_data(), *primitive_out = primitive.mutable_data();
    {
        const py::gil_scoped_release released;
        in_packets(rays, [&](size_t first, std::span<const RayQuery> queries) {
            std::array<ClosestHit, kPacketSize> found;
            tracer.closest(queries, coherence(coherent), found.data());
            for (size_t i = 0; i < queries.size(); ++i) {
                const Maybe<Hit>& hit = found[i].hit;
                t_out[first + i] = hit ? hit->t : std::numeric_limits<double>::infinity();
                instance_out[first + i] = hit ? static_cast<int32_t>(hit->instance) : -1;
                primitive_out[first + i] = hit ? static_cast<int32_t>(hit->local.primitive) : -1;
                const Vec3d place = hit ? tracer.surface_point(*queries[i].ray, *hit).position : Vec3d(0.0);
                for (int axis = 0; axis < 3; ++axis)
                    position_out[3 * (first + i) + static_cast<size_t>(axis)] = place[axis];
            }
        });
    }
    return py::dict(py::arg("t") = t, py::arg("instance") = instance, py::arg("primitive") = primitive,
                    py::arg("position") = position);
}

py::array_t<bool> occluded_in_packets(const Tracer& tracer, const Array<double>& origins,
                                      const Array<double>& directions, const Array<double>& t_max, bool coherent,
                                      const Array<float>& times) {
    const RayArrays rays = ray_arrays(origins, directions, number(0.0), t_max, times);
    py::array_t<bool> result(rays.size());
    bool* out = result.mutable_data();
    const py::gil_scoped_release released;
    in_packets(rays, [&](size_t first, std::span<const RayQuery> queries) {
        const uint32_t hit = tracer.occluded(queries, coherence(coherent));
        for (size_t i = 0; i < queries.size(); ++i) out[first + i] = (hit >> i & 1u) != 0;
    });
    return result;
}

}  // namespace

void bind_packets(py::module_& module) {
    module.def("closest_in_packets", &closest_in_packets, py::arg("tracer"), py::arg("origins"), py::arg("directions"),
               py::arg("coherent") = false, py::arg("times") = Array<float>(0), py::arg("starts") = Array<uint32_t>(0),
               "As Tracer.closest_hits, sixteen rays at once: t, instance, primitive, position.");
    module.def("occluded_in_packets", &occluded_in_packets, py::arg("tracer"), py::arg("origins"),
               py::arg("directions"), py::arg("t_max") = number(std::numeric_limits<double>::infinity()),
               py::arg("coherent") = false, py::arg("times") = Array<float>(0),
               "As Tracer.occluded, sixteen rays at once.");
}

FoundPoints found_points(const Tracer& tracer, const std::vector<Ray>& rays, Visibility kind, SurfaceDetail detail) {
    FoundPoints found{std::vector<Maybe<Hit>>(rays.size()), std::vector<SurfacePoint>(rays.size())};
    std::vector<SurfaceQuery> queries;
    for (size_t i = 0; i < rays.size(); ++i) {
        found.hits[i] = tracer.closest_hit(rays[i], kind);
        if (found.hits[i]) queries.push_back({&rays[i], &*found.hits[i], &found.points[i]});
    }
    if (rays.size() > 1)
        tracer.surface_points(queries, detail);
    else
        for (const SurfaceQuery& each : queries) *each.point = tracer.surface_point(*each.ray, *each.hit, detail);
    return found;
}

}  // namespace rayleaf
