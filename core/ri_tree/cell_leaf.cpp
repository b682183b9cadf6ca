#include "ri_tree/cell_leaf.h"

namespace rayleaf {
namespace {

Vec3d unfolded(const FoldedVector& folded, double a, double b) {
    const double rest = 1.0 - a * a - b * b;
    Vec3d v;
    v[folded.third] = folded.sign * std::sqrt(std::max(rest, 0.0));
    v[(folded.third + 1) % 3] = a;
    v[(folded.third + 2) % 3] = b;
    return rest < 0.0 ? v / std::sqrt(1.0 - rest) : v;
}

}  // namespace

int leaf_value_count(OutputKind kind) {
    switch (kind) {
        case OutputKind::Simple:
            return 5;
        case OutputKind::Mirror:
            return 3;
        case OutputKind::Glass:
            return 8;
        case OutputKind::Volume:
            return 1;
    }
    return 0;
}

OutputRay output_of(OutputKind kind, const CellLeaf& leaf, const float* values, size_t stride, const LineGeometry& line,
                    const Vec3d& box_center) {
    const auto value = [&](size_t i) { return static_cast<double>(values[i * stride]); };
    OutputRay ray;
    ray.sample_class = leaf.sample_class;
    if (kind == OutputKind::Volume) {
        ray.length = std::max(value(0), 0.0);
        return ray;
    }
    const int b = (line.axis + 1) % 3, c = (line.axis + 2) % 3;
    const double depth = value(0);
    ray.position[line.axis] = box_center[line.axis] + depth;
    ray.position[b] = box_center[b] + (line.intercept[0] + line.slope[0] * depth);
    ray.position[c] = box_center[c] + (line.intercept[1] + line.slope[1] * depth);
    ray.normal = unfolded(leaf.normal, value(1), value(2));
    ray.exit_position = ray.position;
    if (kind == OutputKind::Simple) {
        ray.uv = {value(3), value(4)};
        ray.exit_direction = ray.normal;
    } else if (kind == OutputKind::Mirror) {
        ray.exit_direction = mirrored(line.direction, ray.normal);
    } else {
        ray.exit_position = {value(3), value(4), value(5)};
        ray.exit_direction = unfolded(leaf.exit_direction, value(6), value(7));
    }
    return ray;
}

}  // namespace rayleaf
