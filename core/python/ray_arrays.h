// Rays that come and answers that go as NumPy arrays, for the bindings of ray caches and of their rivals.
#pragma once

#include "base/largest.h"
#include "base/thread_clock.h"
#include "python/arrays.h"
#include "ri_tree/ray_cache.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace rayleaf {

inline std::vector<Ray> rays_from(const Array<double>& origins, const Array<double>& directions) {
    check_shape("rays", "origins", origins, {-1, 3});
    check_shape("rays", "directions", directions, {-1, 3});
    if (origins.shape(0) != directions.shape(0))
        throw InputError("rays", "directions", shape_text(directions), shape_text(origins));
    std::vector<Ray> rays(static_cast<size_t>(origins.shape(0)));
    for (size_t i = 0; i < rays.size(); ++i) {
        const double *o = origins.data() + 3 * i, *d = directions.data() + 3 * i;
        rays[i].origin = {o[0], o[1], o[2]};
        rays[i].direction = {d[0], d[1], d[2]};
    }
    return rays;
}

/// What goes to Embree as it is: it ends the process for numbers that it cannot multiply.
inline void check_for_embree(const std::vector<Ray>& rays) {
    constexpr double kLargest = 1e18;
    for (const Ray& ray : rays)
        for (const Vec3d& v : {ray.origin, ray.direction})
            if (!is_finite(v) || max_abs(v) > kLargest)
                throw InputError("rays", "origins and directions", place_text(v), "finite numbers up to 1e18");
}

/// One array an attribute: `value(i)` of each output, `width` numbers or, for 0, a single one.
template <typename T, typename Value>
py::array_t<T> column(size_t count, size_t width, const Value& value) {
    const py::array::ShapeContainer rows{static_cast<py::ssize_t>(count),
                                         static_cast<py::ssize_t>(std::max<size_t>(width, 1))};
    py::array_t<T> result(rows);
    T* out = result.mutable_data();
    for (size_t i = 0; i < count; ++i) {
        if constexpr (requires { value(i).x; }) {
            const auto v = value(i);
            for (size_t k = 0; k < width; ++k) out[i * width + k] = static_cast<T>(v[static_cast<int>(k)]);
        } else {
            out[i] = static_cast<T>(value(i));
        }
    }
    if (width > 0) return result;
    return result.reshape({static_cast<py::ssize_t>(count)});
}

constexpr std::pair<const char*, OutputKind> kOutputKinds[] = {{"SIMPLE", OutputKind::Simple},
                                                               {"MIRROR", OutputKind::Mirror},
                                                               {"GLASS", OutputKind::Glass},
                                                               {"VOLUME", OutputKind::Volume}};

/// Rays are asked in blocks of so many, as a renderer asks tiles: what comes and goes stays in the processor's cache.
inline constexpr size_t kBlockRays = 1024;

/// Rays in object space and what they are answered, in blocks; the processor seconds of `answer(rays, first, out)`.
template <typename Out, typename Answer>
double timed_blocks(const std::vector<Ray>& rays, std::vector<Out>& all, const Answer& answer) {
    const py::gil_scoped_release released;
    std::vector<Out> block(kBlockRays);
    std::vector<Ray> block_rays(kBlockRays);
    double seconds = 0.0;
    for (size_t first = 0; first < rays.size(); first += kBlockRays) {
        const size_t count = std::min(kBlockRays, rays.size() - first);
        std::copy_n(rays.begin() + static_cast<std::ptrdiff_t>(first), count, block_rays.begin());
        const double begin = thread_seconds();
        answer(std::span<const Ray>(block_rays.data(), count), first, std::span<Out>(block.data(), count));
        seconds += thread_seconds() - begin;
        std::copy_n(block.begin(), count, all.begin() + static_cast<std::ptrdiff_t>(first));
    }
    return seconds;
}

inline std::vector<RaySpacing> spacings_from(size_t count, const std::optional<Array<float>>& distances,
                                             const std::optional<Array<float>>& angles) {
    if (!distances && !angles) return {};
    std::vector<RaySpacing> spacings(count);
    const auto length = static_cast<py::ssize_t>(count);
    if (distances) check_shape("rays", "distances", *distances, {length});
    if (angles) check_shape("rays", "angles", *angles, {length});
    for (size_t i = 0; i < count; ++i) {
        if (distances) spacings[i].distance = distances->data()[i];
        if (angles) spacings[i].angle = angles->data()[i];
    }
    return spacings;
}

}  // namespace rayleaf
