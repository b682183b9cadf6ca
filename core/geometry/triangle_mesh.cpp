#include "geometry/triangle_mesh.h"

#include "base/error.h"
#include "geometry/facet_rise.h"
#include "geometry/parameter_slopes.h"
#include "geometry/volume_grids.h"

#include <algorithm>

namespace rayleaf {
namespace {

void require_finite(const std::string& name, const char* argument, std::span<const float> values) {
    const auto bad = std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
    if (bad == values.end()) return;
    throw InputError(name, argument + ("[" + std::to_string(bad - values.begin()) + "]"), number_text(*bad),
                     "a finite number");
}

void require_size(const std::string& name, const char* argument, size_t got, size_t wanted) {
    if (got != wanted) throw InputError(name, argument, std::to_string(got) + " numbers", std::to_string(wanted));
}

void require_multiple_of_three(const std::string& name, const char* argument, size_t got) {
    if (got % 3 != 0) throw InputError(name, argument, std::to_string(got) + " numbers", "a multiple of 3");
}

/// Derivatives of the weights of vertices 1 and 2 by the texture coordinates; zero if these do not span the triangle.
ParameterSlopes weight_slopes(const Vec2f& uv0, const Vec2f& uv1, const Vec2f& uv2) {
    constexpr Vec2d kNoCoordinates(0.0, 0.0);
    return parameter_slopes(Vec2d(uv1) - Vec2d(uv0), Vec2d(uv2) - Vec2d(uv0))
        .value_or(ParameterSlopes{kNoCoordinates, kNoCoordinates});
}

/// Of a triangle's corner normals; not unit.
Vec3f mean_normal(const std::array<Vec3f, 3>& normals, const LocalHit& hit) {
    return normals[0] * (1.0f - hit.u - hit.v) + normals[1] * hit.u + normals[2] * hit.v;
}

}  // namespace

TriangleMesh::TriangleMesh(TriangleMeshArrays arrays)
    : Shape(ShapeKind::TriangleMesh, std::move(arrays.name)), layout_(arrays.layout), grids_(std::move(arrays.grids)) {
    set_vertices(arrays);
    set_triangles(arrays.triangles);
    const bool normals_move = deforms() && !arrays.moved_normals.empty();
    set_corner_normals(normals_move ? arrays.moved_normals : arrays.corner_normals, normals_move ? steps() : 1);
    set_material_slots(arrays.material_slots);
    set_attributes(std::move(arrays.attributes), arrays.active_uv);
}

void TriangleMesh::set_vertices(const TriangleMeshArrays& arrays) {
    require_multiple_of_three(name(), "vertices", arrays.vertices.size());
    require_finite(name(), "vertices", arrays.vertices);
    require_finite(name(), "moved_vertices", arrays.moved_vertices);
    const size_t size = arrays.vertices.size();
    if (size > 0 && !arrays.moved_vertices.empty()) {
        steps_ = arrays.moved_vertices.size() / size;
        if (steps_ < 2 || steps_ * size != arrays.moved_vertices.size())
            throw InputError(name(), "moved_vertices", std::to_string(arrays.moved_vertices.size()) + " numbers",
                             "two or more times " + std::to_string(size));
    }
    const std::span<const float> all = deforms() ? arrays.moved_vertices : arrays.vertices;
    const auto box_of = [](std::span<const float> of) {
        Box3d box;
        for (size_t i = 0; i < of.size(); i += 3) box.extendBy(Vec3d(of[i], of[i + 1], of[i + 2]));
        return box;
    };
    object_bounds_ = box_of(arrays.vertices);
    frame_ = LocalFrame::fitting(box_of(all));
    vertices_.reserve(all.size() / 3);
    for (size_t i = 0; i < all.size(); i += 3) {
        vertices_.push_back(frame_.to_local(Vec3d(all[i], all[i + 1], all[i + 2])));
        bounds_.extendBy(vertices_.back());
    }
}

void TriangleMesh::set_triangles(std::span<const int32_t> triangles) {
    require_multiple_of_three(name(), "triangles", triangles.size());
    const auto count = static_cast<int64_t>(vertex_count());
    triangles_.resize(triangles.size() / 3);
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (triangles[i] < 0 || triangles[i] >= count)
            throw InputError(name(), "triangles[" + std::to_string(i) + "]", std::to_string(triangles[i]),
                             "a vertex index below " + std::to_string(count));
        triangles_[i / 3][i % 3] = static_cast<uint32_t>(triangles[i]);
    }
    for (uint32_t i = 0; i < triangles_.size(); ++i)
        if (is_flat(i)) triangles_[i].fill(triangles_[i][0]);
}

/// Without area, at all times.
bool TriangleMesh::is_flat(uint32_t triangle) const {
    for (size_t step = 0; step < steps(); ++step)
        if (max_abs(area_vector(corners_at(triangle, step))) != 0.0) return false;
    return true;
}

void TriangleMesh::set_corner_normals(std::span<const float> normals, size_t steps) {
    if (normals.empty()) return;
    require_size(name(), "corner_normals", normals.size(), 9 * triangles_.size() * steps);
    require_finite(name(), "corner_normals", normals);
    corner_normals_.reserve(3 * triangles_.size() * steps);
    for (size_t i = 0; i < normals.size(); i += 3)
        corner_normals_.push_back(normalized_or(Vec3f(normals[i], normals[i + 1], normals[i + 2]), Vec3f(0.0f)));
}

void TriangleMesh::set_material_slots(std::span<const int32_t> slots) {
    if (slots.empty()) return;
    require_size(name(), "material_slots", slots.size(), triangles_.size());
    material_slots_ = checked_material_slots(name(), slots);
}

void TriangleMesh::set_attributes(std::vector<CornerAttribute> attributes, AttributeId active_uv) {
    attributes_ = std::move(attributes);
    for (size_t i = 0; i < attributes_.size(); ++i) {
        const CornerAttribute& attribute = attributes_[i];
        const std::string argument = "attributes[" + std::to_string(i) + "]";
        if (attribute.channels < 1 || attribute.channels > 4)
            throw InputError(name(), argument + ".channels", std::to_string(attribute.channels), "1 to 4");
        require_size(name(), argument.c_str(), attribute.values.size(), 3 * triangles_.size() * attribute.channels);
        require_finite(name(), argument.c_str(), attribute.values);
        if (attribute.id == active_uv && attribute.channels >= 2) active_uv_ = static_cast<int>(i);
    }
}

FacetCorners TriangleMesh::corners_at(uint32_t triangle, size_t step) const {
    const std::array<uint32_t, 3>& indices = triangles_[triangle];
    const std::span<const Vec3f> at = vertices(step);
    return {Vec3d(at[indices[0]]), Vec3d(at[indices[1]]), Vec3d(at[indices[2]])};
}

FacetCorners TriangleMesh::moved_corners(uint32_t triangle, float time) const {
    const StepShare step = step_share(time, steps());
    return mixed(corners_at(triangle, step.first), corners_at(triangle, step.first + 1), step.share);
}

float TriangleMesh::normal_length(const LocalHit& hit) const {
    if (corner_normals_.empty()) return 1.0f;
    return mean_normal(normals_at(hit.primitive, hit.time), hit).length();
}

std::array<Vec3f, 3> TriangleMesh::normals_at(uint32_t triangle, float time) const {
    const auto at = [&](size_t step) { return &corner_normals_[3 * (step * triangles_.size() + triangle)]; };
    const Vec3f* normals = at(0);
    if (corner_normals_.size() == 3 * triangles_.size()) return {normals[0], normals[1], normals[2]};
    const StepShare step = step_share(time, steps());
    const Vec3f *before = at(step.first), *after = at(step.first + 1);
    std::array<Vec3f, 3> result;
    for (size_t k = 0; k < 3; ++k) result[k] = before[k] + (after[k] - before[k]) * static_cast<float>(step.share);
    return result;
}

Vec2f TriangleMesh::corner_uv(uint32_t triangle, int corner) const {
    const CornerAttribute& uv = attributes_[active_uv_];
    const float* value = &uv.values[(3 * static_cast<size_t>(triangle) + corner) * uv.channels];
    return {value[0], value[1]};
}

LocalSurface TriangleMesh::surface(const LocalHit& hit) const {
    LocalSurface result;
    result.position = hit.position;
    const Vec3f facet_normal = normalized_or(hit.normal, Vec3f(0, 0, 1));
    result.normal = facet_normal;
    const FacetCorners p = corners(hit.primitive, hit.time);
    ParameterSlopes weights{{0, 0}, {0, 0}};
    if (active_uv_ >= 0) {
        const Vec2f uv0 = corner_uv(hit.primitive, 0), uv1 = corner_uv(hit.primitive, 1);
        const Vec2f uv2 = corner_uv(hit.primitive, 2);
        result.uv = uv0 + (uv1 - uv0) * hit.u + (uv2 - uv0) * hit.v;
        weights = weight_slopes(uv0, uv1, uv2);
        const Vec3d edge1 = p[1] - p[0], edge2 = p[2] - p[0];
        result.dp_du = float_or_zero(edge1 * weights.by_u.x + edge2 * weights.by_u.y);
        result.dp_dv = float_or_zero(edge1 * weights.by_v.x + edge2 * weights.by_v.y);
    }
    if (corner_normals_.empty()) return result;

    const std::array<Vec3f, 3> normals = normals_at(hit.primitive, hit.time);
    const Vec3f sum = mean_normal(normals, hit);
    Vec3f normal = normalized_or(sum, facet_normal);
    const float side = normal.dot(facet_normal) < 0.0f ? -1.0f : 1.0f;
    normal *= side;
    result.normal = normal;
    // Derivative of n = s/|s|: (s' - n (n.s')) / |s|.
    const float length = sum.length();
    if (!(length > 0.0f)) return result;
    const auto derivative = [&](const Vec2d& weight) {
        const Vec3d change = Vec3d(normals[1] - normals[0]) * weight.x + Vec3d(normals[2] - normals[0]) * weight.y;
        const Vec3d n(normal);
        return float_or_zero((change - n * n.dot(change)) * (static_cast<double>(side) / length));
    };
    result.dn_du = derivative(weights.by_u);
    result.dn_dv = derivative(weights.by_v);
    return result;
}

Vec3d TriangleMesh::rise(const LocalHit& hit) const {
    if (corner_normals_.empty()) return Vec3d(0.0);
    const std::array<Vec3f, 3> normals = normals_at(hit.primitive, hit.time);
    return Vec3d(normalized_or(mean_normal(normals, hit), Vec3f(0.0f))) *
           facet_rise(corners(hit.primitive, hit.time), normals, double{hit.u}, double{hit.v});
}

const CornerAttribute* TriangleMesh::find_attribute(AttributeId id) const {
    const auto found = std::find_if(attributes_.begin(), attributes_.end(),
                                    [id](const CornerAttribute& attribute) { return attribute.id == id; });
    return found == attributes_.end() ? nullptr : &*found;
}

std::optional<Vec4f> TriangleMesh::attribute(AttributeId id, const LocalHit& hit) const {
    const CornerAttribute* found = find_attribute(id);
    if (!found) return std::nullopt;
    Vec4f result(0, 0, 0, 1);
    const int channels = found->channels;
    const float* corner = &found->values[3 * static_cast<size_t>(hit.primitive) * channels];
    const float weights[3] = {1.0f - hit.u - hit.v, hit.u, hit.v};
    for (int c = 0; c < channels; ++c)
        result[c] = corner[c] * weights[0] + corner[channels + c] * weights[1] + corner[2 * channels + c] * weights[2];
    return result;
}

uint32_t TriangleMesh::material_slot(const LocalHit& hit) const {
    return material_slots_.empty() ? 0u : material_slots_[hit.primitive];
}

LocalHit TriangleMesh::point_at(LocalHit hit) const {
    const FacetCorners p = corners(hit.primitive, hit.time);
    hit.position = p[0] + (p[1] - p[0]) * double{hit.u} + (p[2] - p[0]) * double{hit.v};
    hit.normal = Vec3f(normalized_or(area_vector(p), Vec3d(0, 0, 1)));
    return hit;
}

ElementPoint TriangleMesh::element_point_at(uint32_t element, const Vec2f& parameters, float time) const {
    ElementPoint result;
    const Vec2f weights = folded(parameters);
    result.hit.primitive = element;
    result.hit.u = weights.x;
    result.hit.v = weights.y;
    result.hit.time = time;
    result.hit = point_at(result.hit);
    result.normal = result.hit.normal;
    result.area_factor = static_cast<float>(0.5 * area_vector(corners(element, time)).length());
    return result;
}

/// What fills a volume has none.
std::optional<ContentHash> TriangleMesh::hash_of_content() const {
    if (grids_) return std::nullopt;
    ContentHasher hasher;
    add_to(hasher);
    hasher.add(steps_);
    hasher.add(vertices_);
    hasher.add(triangles_);
    hasher.add(corner_normals_);
    hasher.add(material_slots_);
    hasher.add(active_uv_);
    for (const CornerAttribute& attribute : attributes_) {
        hasher.add(attribute.id);
        hasher.add(attribute.channels);
        hasher.add(attribute.values);
    }
    return hasher.value();
}

size_t TriangleMesh::bytes() const {
    size_t total = sizeof(*this) + vertices_.capacity() * sizeof(Vec3f) +
                   triangles_.capacity() * sizeof(triangles_[0]) + corner_normals_.capacity() * sizeof(Vec3f) +
                   material_slots_.capacity() * sizeof(uint16_t);
    for (const CornerAttribute& attribute : attributes_) total += attribute.values.capacity() * sizeof(float);
    return total + (grids_ ? grids_->bytes() : 0);
}

}  // namespace rayleaf
