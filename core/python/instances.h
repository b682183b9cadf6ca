// Instances of a scene's description, from Python.
#pragma once

#include "base/error.h"
#include "python/bindings.h"
#include "scene/description.h"

#include <memory>
#include <string>

namespace rayleaf {

using SceneClass = py::class_<SceneDescription, std::shared_ptr<SceneDescription>>;

/// Adds add_instance and add_instances to the class.
void bind_instances(SceneClass& scene);

inline uint8_t visibility_of(const std::string& object, int visibility) {
    constexpr int kMost = kVisibleAll | kOfFootage;
    if (visibility < 0 || visibility > kMost)
        throw InputError(object, "visibility", std::to_string(visibility), "0 to " + std::to_string(kMost));
    return static_cast<uint8_t>(visibility);
}

}  // namespace rayleaf
