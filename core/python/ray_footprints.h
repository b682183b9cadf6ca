// Rays from NumPy arrays.
#pragma once

#include "python/arrays.h"
#include "rays/ray.h"

namespace rayleaf {

/// Rays from arrays of three doubles each, the other numbers one for all or one each.
struct RayArrays {
    Array<double> origins, directions, t_min, t_max;
    Array<float> width = Array<float>(0), spread = Array<float>(0);
    Array<uint32_t> starts = Array<uint32_t>(0);  ///< instance, subpatch, levels, facet; none if empty
    Array<float> times = Array<float>(0);         ///< of the shutter; in the middle if empty

    size_t size() const { return static_cast<size_t>(origins.size() / 3); }
    Ray operator[](size_t i) const {
        const double *o = origins.data() + 3 * i, *d = directions.data() + 3 * i;
        Ray ray;
        ray.origin = {o[0], o[1], o[2]};
        ray.direction = {d[0], d[1], d[2]};
        ray.t_min = t_min.data()[t_min.size() == 1 ? 0 : i];
        ray.t_max = t_max.data()[t_max.size() == 1 ? 0 : i];
        const auto one = [i](const Array<float>& of) {
            return of.size() == 0 ? 0.0f : of.data()[of.size() == 1 ? 0 : i];
        };
        ray.beam = RayBeam::cone(one(width), one(spread));
        if (times.size() > 0) ray.time = one(times);
        if (starts.size() > 0) {
            const uint32_t* start = starts.data() + 4 * i;
            ray.start = {{start[0], start[1], start[2], start[3]}, {}};
        }
        return ray;
    }
    void check() const {
        check_numbers("rays", "origins", origins);
        check_numbers("rays", "directions", directions);
        check_numbers("rays", "t_min", t_min);
        check_numbers("rays", "t_max", t_max);
        check_numbers("rays", "width", width);
        check_numbers("rays", "spread", spread);
        check_numbers("rays", "starts", starts);
        check_numbers("rays", "times", times);
        const auto count = origins.size() / 3;
        if (origins.size() % 3 != 0 || directions.size() != origins.size())
            throw py::value_error("origins and directions must both have shape (n, 3)");
        const auto fits = [count](py::ssize_t size) { return size == 1 || size == count; };
        if (!fits(t_min.size()) || !fits(t_max.size()))
            throw py::value_error("t_min and t_max must be numbers or have one number a ray");
        if ((width.size() > 0 && !fits(width.size())) || (spread.size() > 0 && !fits(spread.size())))
            throw py::value_error("width and spread must be numbers or have one number a ray");
        if (times.size() > 0 && !fits(times.size())) throw py::value_error("times must have one number a ray");
        if (starts.size() > 0 && starts.size() != 4 * count) throw py::value_error("starts must have shape (n, 4)");
    }
};

inline RayArrays ray_arrays(const Array<double>& origins, const Array<double>& directions, const Array<double>& t_min,
                            const Array<double>& t_max, const Array<float>& times = Array<float>(0)) {
    RayArrays rays{origins, directions, t_min, t_max};
    rays.times = times;
    rays.check();
    return rays;
}

inline Array<double> number(double value) {
    Array<double> array(1);
    *array.mutable_data() = value;
    return array;
}
inline Array<float> float_number(float value) {
    Array<float> array(1);
    *array.mutable_data() = value;
    return array;
}

}  // namespace rayleaf
