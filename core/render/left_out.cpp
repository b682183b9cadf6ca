#include "render/left_out.h"

#include "render/session.h"

#include <algorithm>

namespace rayleaf {
namespace {

constexpr auto kKindNames = std::to_array<const char*>(
    {"triangles", "spline_surfaces", "strands", "bevelled_curves", "subdivision_surfaces", "displaced_surfaces"});
static_assert(kKindNames.size() == kShapeKinds);

std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

}  // namespace

const char* shape_kind_name(ShapeKind kind) {
    return kKindNames[static_cast<size_t>(kind)];
}

std::vector<std::string> left_out(const RenderStatistics& s, const Film& film) {
    std::vector<std::string> names;
    const auto add = [&names](bool used, const std::string& name) {
        if (!used) names.push_back(name);
    };
    const auto used = [](const RayCacheReport& each) { return each.used; };
    add(s.has_textures, "texture system");
    add(s.lights > 0, "light sampling");
    add(s.light_linking, "light linking");
    add(std::any_of(s.ray_caches.begin(), s.ray_caches.end(), used), "ray caches");
    add(s.irradiance_records > 0, "irradiance cache");
    add(s.trace.subpatches > 0, "tessellation");
    add(s.volumes > 0, "volume visualisation");
    add(s.target_error > 0.0, "target error");
    add(s.rays.catcher_paths > 0, "shadow catchers");
    for (size_t kind = 0; kind < kShapeKinds; ++kind) add(s.shapes_of[kind].shapes > 0, spaced(kKindNames[kind]));
    for (const PassInfo& entry : kPasses) add(film.has(entry.pass), "pass " + std::string(entry.name));
    return names;
}

}  // namespace rayleaf
