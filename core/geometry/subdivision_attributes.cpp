// Texture coordinates, attributes and custom normals of a subdivision surface.
#include "geometry/parameter_slopes.h"
#include "geometry/subdivision_surface.h"

#include <algorithm>

namespace rayleaf {

/// Without a map the derivatives are by the element's parameters, which serve as well for curvature.
void SubdivisionSurface::set_texture_coordinates(const LocalHit& hit, const PatchPoint& point,
                                                 const LimitNormal& normal, double side, LocalSurface& result) const {
    std::optional<ParameterSlopes> slopes(ParameterSlopes{});
    if (active_uv_ >= 0) {
        const LimitFaces& map = uv_maps_[static_cast<size_t>(active_uv_)].limit;
        const PatchPoint uv = in_element(map, elements_[hit.primitive], hit.u, hit.v);
        result.uv = Vec2f(static_cast<float>(uv.position.x), static_cast<float>(uv.position.y));
        slopes = parameter_slopes(Vec2d(uv.du.x, uv.du.y), Vec2d(uv.dv.x, uv.dv.y));
        if (!slopes) return;
    }
    const auto [by_u, by_v] = *slopes;
    result.dp_du = float_or_zero(point.du * by_u.x + point.dv * by_u.y);
    result.dp_dv = float_or_zero(point.du * by_v.x + point.dv * by_v.y);
    result.dn_du = float_or_zero((normal.dn_du * by_u.x + normal.dn_dv * by_u.y) * side);
    result.dn_dv = float_or_zero((normal.dn_du * by_v.x + normal.dn_dv * by_v.y) * side);
}

Vec3f SubdivisionSurface::shading_normal(const LocalHit& hit, const Vec3f& of_limit, const Vec3f& facet_normal) const {
    if (corner_normals_.values.empty()) return of_limit;
    const Vec4f sum = interpolated(corner_normals_, hit);
    const Vec3f normal = normalized_or(Vec3f(sum.x, sum.y, sum.z), of_limit);
    return normal.dot(facet_normal) < 0.0f ? -normal : normal;
}

std::optional<Vec4f> SubdivisionSurface::attribute(AttributeId id, const LocalHit& hit) const {
    for (const UvMap& map : uv_maps_) {
        if (map.id != id) continue;
        const Vec3d uv = in_element(map.limit, elements_[hit.primitive], hit.u, hit.v).position;
        return Vec4f(static_cast<float>(uv.x), static_cast<float>(uv.y), 0.0f, 1.0f);
    }
    const auto found = std::find_if(attributes_.begin(), attributes_.end(),
                                    [id](const CornerAttribute& attribute) { return attribute.id == id; });
    if (found == attributes_.end()) return std::nullopt;
    return interpolated(*found, hit);
}

Vec4f SubdivisionSurface::interpolated(const CornerAttribute& attribute, const LocalHit& hit) const {
    const SubdivisionElement& element = elements_[hit.primitive];
    const uint32_t first = first_corner_[element.face], size = first_corner_[element.face + 1] - first;
    const auto at = [&](uint32_t corner, int channel) {
        return attribute.values[size_t{first + corner % size} * static_cast<size_t>(attribute.channels) +
                                static_cast<size_t>(channel)];
    };
    const uint32_t next = element.corner + 1, previous = element.corner + size - 1;
    Vec4f result(0, 0, 0, 1);
    for (int c = 0; c < attribute.channels; ++c) {
        const float here = at(element.corner, c);
        float along_u = at(previous, c), along_v = at(next, c), across = at(element.corner + 2, c);
        if (!element.whole) {
            along_u = 0.5f * (here + along_u);
            along_v = 0.5f * (here + along_v);
            across = 0.0f;
            for (uint32_t k = 0; k < size; ++k) across += at(k, c) / static_cast<float>(size);
        }
        result[c] =
            (here * (1 - hit.u) + along_u * hit.u) * (1 - hit.v) + (along_v * (1 - hit.u) + across * hit.u) * hit.v;
    }
    return result;
}

}  // namespace rayleaf
