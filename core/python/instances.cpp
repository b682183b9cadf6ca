#include "python/instances.h"

#include "python/arrays.h"
#include "python/motions.h"

#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace rayleaf {
namespace {

int add_instance(SceneDescription& scene, const std::string& name, int shape, const Array<double>& matrix,
                 int material_list, int object_index, float random, int visibility, int ray_interpolation,
                 int light_group, const std::string& asset, const std::optional<Array<double>>& motion,
                 float shadow_terminator, const std::optional<std::array<int64_t, 4>>& linking) {
    return scene.add_instance({name,
                               shape,
                               affine_of(name, matrix),
                               material_list,
                               static_cast<float>(object_index),
                               random,
                               visibility_of(name, visibility),
                               ray_interpolation,
                               {},
                               light_group,
                               asset,
                               motion ? motion_of(name, *motion) : nullptr,
                               shadow_terminator,
                               linking ? checked_light_linking(name, *linking) : LightLinking()});
}

using InstanceAttributes = std::map<int, Array<float>>;  ///< by id: (instances, 4)

std::vector<InstanceAttribute> attributes_at(const InstanceAttributes& attributes, py::ssize_t i) {
    std::vector<InstanceAttribute> result;
    for (const auto& [id, values] : attributes) {
        InstanceAttribute attribute{id, {}};
        for (size_t k = 0; k < 4; ++k) {
            const float value = values.data()[4 * i + static_cast<py::ssize_t>(k)];
            attribute.value[k] = std::isfinite(value) ? value : 0.0f;
        }
        result.push_back(attribute);
    }
    return result;
}

LightLinking linking_at(const std::optional<Array<int64_t>>& linkings, const std::string& name, py::ssize_t i) {
    if (!linkings) return {};
    const int64_t* row = linkings->data() + 4 * i;
    return checked_light_linking(name, {row[0], row[1], row[2], row[3]});
}

std::vector<std::string> add_instances(
    SceneDescription& scene, const std::vector<std::string>& names, const Array<int32_t>& shapes,
    const Array<double>& matrices, const Array<int32_t>& material_lists, const Array<int32_t>& object_indices,
    const Array<float>& randoms, const Array<int32_t>& visibilities,
    const std::optional<Array<int32_t>>& ray_interpolations, const std::optional<InstanceAttributes>& attributes,
    const std::optional<Array<int32_t>>& light_groups, const std::optional<std::vector<std::string>>& assets,
    const std::optional<InstanceMotions>& motions, const std::optional<Array<float>>& shadow_terminators,
    const std::optional<Array<int64_t>>& linkings) {
    const auto count = static_cast<py::ssize_t>(names.size());
    constexpr const char* kObject = "instances";
    check_shape(kObject, "shapes", shapes, {count});
    check_shape(kObject, "matrices", matrices, {count, 4, 4});
    check_shape(kObject, "material_lists", material_lists, {count});
    check_shape(kObject, "object_indices", object_indices, {count});
    check_shape(kObject, "randoms", randoms, {count});
    check_shape(kObject, "visibilities", visibilities, {count});
    if (ray_interpolations) check_shape(kObject, "ray_interpolations", *ray_interpolations, {count});
    if (light_groups) check_shape(kObject, "light_groups", *light_groups, {count});
    if (shadow_terminators) check_shape(kObject, "shadow_terminators", *shadow_terminators, {count});
    if (linkings) check_shape(kObject, "linkings", *linkings, {count, 4});
    if (assets && assets->size() != names.size())
        throw InputError(kObject, "assets", std::to_string(assets->size()), "as many as names");
    const InstanceAttributes named = attributes.value_or(InstanceAttributes());
    for (const auto& [id, values] : named) check_shape(kObject, "attributes", values, {count, 4});
    std::vector<std::string> messages;
    for (py::ssize_t i = 0; i < count; ++i) {
        try {
            const std::string& name = names[static_cast<size_t>(i)];
            scene.add_instance({name, shapes.data()[i], affine_of(name, matrices.data() + 16 * i),
                                material_lists.data()[i], static_cast<float>(object_indices.data()[i]),
                                randoms.data()[i], visibility_of(name, visibilities.data()[i]),
                                ray_interpolations ? ray_interpolations->data()[i] : -1, attributes_at(named, i),
                                light_groups ? light_groups->data()[i] : -1,
                                assets ? (*assets)[static_cast<size_t>(i)] : std::string(), motion_at(motions, name, i),
                                shadow_terminators ? shadow_terminators->data()[i] : kShadowTerminator,
                                linking_at(linkings, name, i)});
        } catch (const InputError& error) {
            messages.emplace_back(error.what());
        }
    }
    return messages;
}

}  // namespace

void bind_instances(SceneClass& scene) {
    using namespace pybind11::literals;
    scene
        .def("add_instance", &add_instance, "name"_a, "shape"_a, "matrix"_a, "material_list"_a = -1,
             "object_index"_a = 0, "random"_a = 0.0f, "visibility"_a = static_cast<int>(kVisibleAll),
             "ray_interpolation"_a = -1, "light_group"_a = -1, "asset"_a = "", "motion"_a = py::none(),
             "shadow_terminator"_a = kShadowTerminator, "linking"_a = py::none())
        .def("add_instances", &add_instances, "names"_a, "shapes"_a, "matrices"_a, "material_lists"_a,
             "object_indices"_a, "randoms"_a, "visibilities"_a, "ray_interpolations"_a = py::none(),
             "attributes"_a = py::none(), "light_groups"_a = py::none(), "assets"_a = py::none(),
             "motions"_a = py::none(), "shadow_terminators"_a = py::none(), "linkings"_a = py::none());
}

}  // namespace rayleaf
