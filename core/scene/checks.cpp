#include "scene/checks.h"

#include "base/error.h"
#include "base/largest.h"

namespace rayleaf {
namespace {

void check_volume(const std::string& material, const VolumeVisualisation& volume) {
    if (!(volume.density >= 0.0f && std::isfinite(volume.density)))
        throw InputError(material, "volume density", number_text(volume.density), "0 or a positive finite number");
    const Color& c = volume.color;
    if (!is_finite(c) || c.x < 0.0f || c.y < 0.0f || c.z < 0.0f)
        throw InputError(material, "volume colour", "negative or not finite", "finite numbers of at least 0");
}

}  // namespace

void check_index(const std::string& object, const char* argument, int index, size_t count, int least) {
    if (index < least || index >= static_cast<int>(count))
        throw InputError(
            object, argument, std::to_string(index),
            "an index from " + std::to_string(least) + " to " + std::to_string(static_cast<int>(count) - 1));
}

void check_light_group(const std::string& object, int slot) {
    check_index(object, "light group", slot, kMostSlots, -1);
}

void check_matrix(const std::string& object, const Affine3d& m) {
    if (!is_finite(m.x) || !is_finite(m.y) || !is_finite(m.z) || !is_finite(m.translation))
        throw InputError(object, "matrix", "not finite", "finite numbers");
    if (!is_place(m.x) || !is_place(m.y) || !is_place(m.z) || !is_place(m.translation))
        throw InputError(object, "matrix", "one with larger numbers", kCoordinatesWanted);
    const double lengths = m.x.length() * m.y.length() * m.z.length();
    // Below this share of a box's volume the axes are parallel within double rounding, and no inverse can be trusted.
    constexpr double kFlat = 1e-12;
    if (!(std::abs(m.determinant()) > kFlat * lengths))
        throw InputError(object, "scale", "zero in some direction (or axes that are parallel)",
                         "a matrix that can be inverted");
}

std::shared_ptr<const Motion> checked_motion(const std::string& object, std::span<const Affine3d> places) {
    if (places.size() < 2)
        throw InputError(object, "motion", "of " + std::to_string(places.size()) + " matrices",
                         "at least two matrices");
    for (const Affine3d& m : places)
        if (!is_place(m.x) || !is_place(m.y) || !is_place(m.z) || !is_place(m.translation))
            throw InputError(object, "motion", "a matrix with larger numbers, or not finite", kCoordinatesWanted);
    const auto is_first = [&](const Affine3d& m) {
        const Affine3d& first = places.front();
        return m.x == first.x && m.y == first.y && m.z == first.z && m.translation == first.translation;
    };
    if (std::all_of(places.begin(), places.end(), is_first)) return nullptr;
    return std::make_shared<const Motion>(places);
}

Material checked_material(Material material) {
    if (material.volume) check_volume(material.name, *material.volume);
    check_displacement(material.name, material.displacement);
    material.bounds_medium_alone = material.medium && !material.surface;
    return material;
}

}  // namespace rayleaf
