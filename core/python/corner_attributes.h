// Attributes of a mesh's corners from Python's arrays.
#pragma once

#include "geometry/triangle_mesh.h"
#include "python/arrays.h"

#include <map>
#include <string>
#include <vector>

namespace rayleaf {

/// Per-corner attributes: id -> (triangles, 3, channels).
inline std::vector<CornerAttribute> corner_attributes(const std::string& name,
                                                      const std::map<int, Array<float>>& arrays,
                                                      py::ssize_t triangles) {
    std::vector<CornerAttribute> attributes;
    for (const auto& [id, array] : arrays) {
        check_shape(name, "attributes", array, {triangles, 3, -1});
        const std::span<const float> values = span_of(array);
        attributes.push_back({id, static_cast<int>(array.shape(2)), {values.begin(), values.end()}});
    }
    return attributes;
}

}  // namespace rayleaf
