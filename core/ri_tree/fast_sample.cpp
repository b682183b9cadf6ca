#include "ri_tree/fast_sample.h"

#include "ri_tree/convex_path.h"

namespace rayleaf {
namespace {

float stored(double value) {
    const auto result = static_cast<float>(value);
    return std::isfinite(result) ? result : 0.0f;
}

/// The values of an output ray, or of its derivative: `OutputChange` has the same attributes.
template <typename Output>
std::array<double, kMostSampleValues> values_of(OutputKind kind, const Output& output, double depth) {
    std::array<double, kMostSampleValues> values{};
    const auto put = [&](int first, const Vec3d& v) {
        for (int i = 0; i < 3; ++i) values[first + i] = v[i];
    };
    if (kind == OutputKind::Volume) {
        values[sample_value::kLength] = output.length;
        return values;
    }
    values[sample_value::kDepth] = depth;
    put(sample_value::kNormal, output.normal);
    if (kind == OutputKind::Simple) {
        values[sample_value::kUv] = output.uv.x;
        values[sample_value::kUv + 1] = output.uv.y;
    } else if (kind == OutputKind::Glass) {
        put(sample_value::kExitPosition, output.exit_position);
        put(sample_value::kExitDirection, output.exit_direction);
    }
    return values;
}

/// Whether the output ray was found by following.
bool is_followed(const SampleTracer& tracer, const ConvexBody* body, const Ray& ray, const RayChanges& ray_changes,
                 OutputRay& output, OutputChanges& changes) {
    return body && follow_glass(*body, tracer, ray, ray_changes, output, changes) != ConvexBody::Meeting::Uncertain;
}

}  // namespace

int sample_value_count(OutputKind kind) {
    switch (kind) {
        case OutputKind::Simple:
            return 6;
        case OutputKind::Mirror:
            return 4;
        case OutputKind::Glass:
            return 10;
        case OutputKind::Volume:
            return 1;
    }
    return 0;
}

RayChanges line_changes(const LineSpace& space, const Ray& ray, int axis) {
    const std::array<double, kLineAxes> half_sides = space.root_half_sides(axis);
    const double from_middle = ray.origin[axis] - space.center()[axis];
    RayChanges changes;
    for (int i = 0; i < 2; ++i) {
        const int other = (axis + 1 + i) % 3;
        Vec3d unit(0.0);
        unit[other] = 1.0;
        changes[i].position = unit * half_sides[i];
        changes[i + 2].position = unit * (from_middle * half_sides[i + 2]);
        changes[i + 2].direction =
            (unit - ray.direction * ray.direction[other]) * (ray.direction[axis] * half_sides[i + 2]);
    }
    return changes;
}

FastSample take_sample(const SampleTracer& tracer, const ConvexBody* body, const LineSpace& space,
                       const LatticePoint& point, SampleContents contents) {
    const OutputKind kind = tracer.settings().kind;
    const int axis = point.direction / 2, count = sample_value_count(kind);
    const Ray ray = space.lattice_ray(point.direction, point.place);
    OutputRay output;
    OutputChanges changes;
    if (contents == SampleContents::Values) {
        output = tracer.trace(ray);
    } else {
        const RayChanges ray_changes = line_changes(space, ray, axis);
        if (!is_followed(tracer, body, ray, ray_changes, output, changes))
            output = tracer.trace(ray, ray_changes, changes);
    }
    FastSample sample;
    sample.sample_class = output.sample_class;
    if (output.sample_class.is_miss()) return sample;
    const auto values = values_of(kind, output, output.position[axis] - space.center()[axis]);
    for (int i = 0; i < count; ++i) sample.values[i] = stored(values[i]);
    if (contents == SampleContents::Values) return sample;
    for (int k = 0; k < kLineAxes; ++k) {
        const auto by_axis = values_of(kind, changes[k], changes[k].position[axis]);
        for (int i = 0; i < count; ++i) sample.changes[i][k] = stored(by_axis[i]);
    }
    return sample;
}

}  // namespace rayleaf
