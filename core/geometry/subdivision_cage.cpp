#include "geometry/subdivision_cage.h"

#include "base/error.h"
#include "geometry/shape.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayleaf {
namespace {

/// Elements are counted in 32 bits, with room for the lines between them.
constexpr int64_t kMostCorners = int64_t{1} << 28;

std::string indexed(const char* argument, size_t index) {
    return std::string(argument) + "[" + std::to_string(index) + "]";
}

class Check {
  public:
    explicit Check(const std::string& object) : object_(&object) {}

    [[noreturn]] void fail(const std::string& argument, const std::string& got, const std::string& wanted) const {
        throw InputError(*object_, argument, got, wanted);
    }
    void size(const char* argument, size_t got, size_t wanted) const {
        if (got != wanted) fail(argument, std::to_string(got) + " numbers", std::to_string(wanted));
    }
    void finite(const char* argument, std::span<const float> values) const {
        const auto bad = std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
        if (bad != values.end())
            fail(indexed(argument, static_cast<size_t>(bad - values.begin())), number_text(*bad), "a finite number");
    }
    void sharpness(const char* argument, std::span<const float> values) const {
        finite(argument, values);
        const auto bad = std::find_if(values.begin(), values.end(), [](float value) { return value < 0.0f; });
        if (bad != values.end())
            fail(indexed(argument, static_cast<size_t>(bad - values.begin())), number_text(*bad), "0 or more");
    }
    void indices(const char* argument, std::span<const int32_t> values, int64_t count, const char* of) const {
        for (size_t i = 0; i < values.size(); ++i)
            if (values[i] < 0 || values[i] >= count)
                fail(indexed(argument, i), std::to_string(values[i]), of + (" below " + std::to_string(count)));
    }

  private:
    const std::string* object_;
};

void check_faces(const Check& check, const SubdivisionCage& cage, int64_t vertex_count) {
    int64_t total = 0;
    for (size_t i = 0; i < cage.face_sizes.size(); ++i) {
        if (cage.face_sizes[i] < 3 || cage.face_sizes[i] > kMostAtVertex)
            check.fail(indexed("face_sizes", i), std::to_string(cage.face_sizes[i]),
                       "3 to " + std::to_string(kMostAtVertex) + " corners");
        total += cage.face_sizes[i];
    }
    check.size("corners", cage.corners.size(), static_cast<size_t>(total));
    if (total > kMostCorners) check.fail("corners", std::to_string(total), "at most " + std::to_string(kMostCorners));
    check.indices("corners", cage.corners, vertex_count, "a vertex index");
    std::vector<int32_t> of_face;
    size_t first = 0;
    for (size_t face = 0; face < cage.face_sizes.size(); ++face) {
        const auto begin = cage.corners.begin() + static_cast<std::ptrdiff_t>(first);
        of_face.assign(begin, begin + cage.face_sizes[face]);
        first += static_cast<size_t>(cage.face_sizes[face]);
        std::sort(of_face.begin(), of_face.end());
        const auto twice = std::adjacent_find(of_face.begin(), of_face.end());
        if (twice != of_face.end())
            check.fail("face " + std::to_string(face), "one that has vertex " + std::to_string(*twice) + " twice",
                       "corners that differ");
    }
    std::vector<int> faces(static_cast<size_t>(vertex_count));
    for (const int32_t vertex : cage.corners)
        if (++faces[static_cast<size_t>(vertex)] > kMostAtVertex)
            check.fail("vertex " + std::to_string(vertex), "part of more faces",
                       "a vertex of at most " + std::to_string(kMostAtVertex) + " faces");
}

void check_attributes(const Check& check, const char* argument, const std::vector<CornerAttribute>& attributes,
                      size_t corners, int least_channels) {
    for (size_t i = 0; i < attributes.size(); ++i) {
        const CornerAttribute& attribute = attributes[i];
        const std::string name = indexed(argument, i);
        if (attribute.channels < least_channels || attribute.channels > 4)
            check.fail(name + ".channels", std::to_string(attribute.channels),
                       std::to_string(least_channels) + " to 4");
        check.size(name.c_str(), attribute.values.size(), corners * static_cast<size_t>(attribute.channels));
        check.finite(name.c_str(), attribute.values);
    }
}

}  // namespace

void validate(const SubdivisionCage& cage) {
    const Check check(cage.name);
    if (cage.vertices.size() % 3 != 0)
        check.fail("vertices", std::to_string(cage.vertices.size()) + " numbers", "a multiple of 3");
    check.finite("vertices", cage.vertices);
    const auto vertex_count = static_cast<int64_t>(cage.vertices.size() / 3);
    check_faces(check, cage, vertex_count);
    check.size("crease_edges", cage.crease_edges.size(), 2 * cage.crease_sharpness.size());
    check.size("crease_vertices", cage.crease_vertices.size(), cage.vertex_sharpness.size());
    check.sharpness("crease_sharpness", cage.crease_sharpness);
    check.sharpness("vertex_sharpness", cage.vertex_sharpness);
    check.indices("crease_edges", cage.crease_edges, vertex_count, "a vertex index");
    check.indices("crease_vertices", cage.crease_vertices, vertex_count, "a vertex index");
    if (!cage.material_slots.empty()) {
        check.size("material_slots", cage.material_slots.size(), cage.face_sizes.size());
        check.indices("material_slots", cage.material_slots, kLargestMaterialSlot + 1, "a slot");
    }
    if (!cage.corner_normals.empty()) check.size("corner_normals", cage.corner_normals.size(), 3 * cage.corners.size());
    check.finite("corner_normals", cage.corner_normals);
    check_attributes(check, "uv_maps", cage.uv_maps, cage.corners.size(), 2);
    check_attributes(check, "attributes", cage.attributes, cage.corners.size(), 1);
}

}  // namespace rayleaf
