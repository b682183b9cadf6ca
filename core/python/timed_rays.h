// Rays that are traced one after the other, with the processor time that they take.
#pragma once

#include "base/thread_clock.h"
#include "python/bindings.h"
#include "python/ray_footprints.h"

#include <limits>
#include <vector>

namespace rayleaf {

/// Rays without end, with the footprints and starts of RayArrays.
inline std::vector<Ray> whole_rays(const Array<double>& origins, const Array<double>& directions,
                                   const Array<float>& width, const Array<float>& spread,
                                   const Array<uint32_t>& starts) {
    const RayArrays arrays{origins, directions, number(0.0), number(std::numeric_limits<double>::infinity()),
                           width,   spread,     starts};
    arrays.check();
    std::vector<Ray> rays;
    rays.reserve(arrays.size());
    for (size_t i = 0; i < arrays.size(); ++i) rays.push_back(arrays[i]);
    return rays;
}

/// (processor seconds of this thread, t of each ray's nearest hit), where `closest(ray)` finds t.
template <typename Closest>
py::tuple timed_rays(const std::vector<Ray>& rays, const Closest& closest) {
    py::array_t<double> t(static_cast<py::ssize_t>(rays.size()));
    double* out = t.mutable_data();
    double seconds = 0;
    {
        const py::gil_scoped_release released;
        const double begin = thread_seconds();
        for (size_t i = 0; i < rays.size(); ++i) out[i] = closest(rays[i]);
        seconds = thread_seconds() - begin;
    }
    return py::make_tuple(seconds, t);
}

}  // namespace rayleaf
