#include "scene/occupancy.h"

#include "geometry/patch_surface.h"
#include "geometry/triangle_mesh.h"
#include "trace/shape_parts.h"

#include <algorithm>
#include <numeric>

namespace rayleaf {
namespace {

/// Boxes that reach into one another by this share of the smaller one's size only touch: a vase stands on a table.
constexpr double kTouching = 1e-3;

/// The box of an element, local space of the shape; for patches and triangles.
GroupedBoxes::BoxOf element_boxes(const Shape& shape) {
    if (shape.kind() == ShapeKind::PatchSurface)
        return
            [&surface = static_cast<const PatchSurface&>(shape)](uint32_t patch) { return surface.patch_box(patch); };
    return
        [&mesh = static_cast<const TriangleMesh&>(shape)](uint32_t triangle) { return triangle_box(mesh, triangle); };
}

/// Where on a curve through all of a box a point lies: bits of its three places in turn (Morton 1966).
uint64_t place_on_curve(const Vec3d& point, const Box3d& all) {
    constexpr int kBits = 20;
    uint64_t place = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = all.max[axis] - all.min[axis];
        const double share = size > 0.0 ? std::clamp((point[axis] - all.min[axis]) / size, 0.0, 1.0) : 0.0;
        const auto along = static_cast<uint64_t>(share * ((1 << kBits) - 1));
        for (int bit = 0; bit < kBits; ++bit) place |= (along >> bit & 1) << (3 * bit + axis);
    }
    return place;
}

std::vector<uint32_t> order_in_space(const Tracer& tracer, size_t count) {
    const Box3d all = tracer.bounds();
    std::vector<uint64_t> places(count);
    for (uint32_t i = 0; i < count; ++i)
        if (!tracer.bounds(i).isEmpty()) places[i] = place_on_curve(tracer.bounds(i).center(), all);
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return places[a] < places[b]; });
    return order;
}

}  // namespace

Occupancy::Occupancy(const SceneDescription& description, const Tracer& tracer, const CancelToken& cancel)
    : description_(description),
      tracer_(tracer),
      cancel_(cancel),
      order_(order_in_space(tracer, description.instances.size())),
      instances_(
          static_cast<uint32_t>(order_.size()), [&](uint32_t place) { return tracer.bounds(order_[place]); }, cancel) {}

bool Occupancy::has_element_in(const Shape& shape, const Box3d& box) {
    if (shape.kind() != ShapeKind::PatchSurface && shape.kind() != ShapeKind::TriangleMesh) return true;
    const GroupedBoxes::BoxOf box_of = element_boxes(shape);
    auto known = elements_.find(&shape);
    if (known == elements_.end())
        known = elements_.emplace(&shape, GroupedBoxes(shape.element_count(), box_of, cancel_)).first;
    return known->second.any(box, [&](uint32_t element) { return box.intersects(box_of(element)); });
}

bool Occupancy::is_occupied(uint32_t instance) {
    cancel_.throw_if_cancelled();
    Box3d box = tracer_.bounds(instance);
    const double touching = kTouching * max_component(box.size());
    box.min += Vec3d(touching);
    box.max -= Vec3d(touching);
    const auto is_inside = [&](uint32_t place) {
        const uint32_t other = order_[place];
        if (other == instance || !box.intersects(tracer_.bounds(other))) return false;
        if (tracer_.instance(other).motion) return true;  // it may be anywhere in its bounds
        const Affine3d to_local = tracer_.local_to_world(other, kMiddleTime).inverse();
        return has_element_in(*tracer_.instance(other).shape, image_of(box, to_local));
    };
    if (instances_.any(box, is_inside)) return true;
    return std::any_of(description_.lamps.begin(), description_.lamps.end(), [&](const Lamp& lamp) {
        return lamp.kind != LampKind::Sun && box.intersects(lamp.to_world.translation);
    });
}

}  // namespace rayleaf
