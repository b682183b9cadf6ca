#include "geometry/shape.h"

#include "base/error.h"

namespace rayleaf {

LocalFrame LocalFrame::fitting(const Box3d& box) {
    LocalFrame frame;
    if (box.isEmpty()) return frame;
    frame.center = (box.min + box.max) * 0.5;
    const double half = max_component(box.max - box.min) * 0.5;
    if (half > 0.0) frame.scale = std::exp2(std::ceil(std::log2(half)));
    return frame;
}

std::vector<uint16_t> checked_material_slots(const std::string& shape, std::span<const int32_t> slots) {
    std::vector<uint16_t> result;
    result.reserve(slots.size());
    for (const int32_t slot : slots) {
        if (slot < 0 || slot > kLargestMaterialSlot)
            throw InputError(shape, "material_slots", std::to_string(slot),
                             "0 to " + std::to_string(kLargestMaterialSlot));
        result.push_back(static_cast<uint16_t>(slot));
    }
    return result;
}

void Shape::set_texture_space(const Box3d& box) {
    if (!is_finite(box.min) || !is_finite(box.max) || box.isEmpty())
        throw InputError(name_, "texture space", "not a box", "finite corners, the low one first");
    texture_space_ = box;
}

void Shape::line_points(uint32_t element, float u, std::span<const float> v, PlacedPoint* points) const {
    for (size_t i = 0; i < v.size(); ++i) {
        points[i].hit = element_point(element, {u, v[i]}).hit;
        points[i].surface = surface(points[i].hit);
    }
}

}  // namespace rayleaf
