#include "geometry/patch_surface.h"
#include "geometry/swept_curve_making.h"
#include "geometry/swept_surface.h"
#include "geometry/triangle_mesh.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/corner_attributes.h"
#include "python/instances.h"
#include "python/motions.h"
#include "scene/description.h"
#include "scene/edits.h"
#include "scene/scene_parts.h"
#include "splines/nurbs.h"

#include <array>
#include <map>

namespace rayleaf {
namespace {

constexpr std::pair<const char*, LampKind> kLampKinds[] = {{"POINT", LampKind::Point},
                                                           {"SUN", LampKind::Sun},
                                                           {"SPOT", LampKind::Spot},
                                                           {"RECTANGLE", LampKind::Rectangle},
                                                           {"DISK", LampKind::Disk}};

LampKind lamp_kind(const std::string& object, const std::string& name) {
    for (const auto& [text, kind] : kLampKinds)
        if (name == text) return kind;
    throw InputError(object, "kind", "'" + name + "'", "POINT, SUN, SPOT, RECTANGLE or DISK");
}

SpotProfile spot_profile_of(const std::string& object, const std::string& name) {
    if (name == "COSINE") return SpotProfile::Cosine;
    if (name == "EVEN") return SpotProfile::Even;
    throw InputError(object, "spot profile", "'" + name + "'", "COSINE or EVEN");
}

ColorSpace color_space(const std::string& object, const std::string& name) {
    if (name == "SRGB") return ColorSpace::Srgb;
    if (name == "LINEAR") return ColorSpace::Linear;
    if (name == "NON_COLOR") return ColorSpace::NonColor;
    throw InputError(object, "color space", "'" + name + "'", "SRGB, LINEAR or NON_COLOR");
}

/// Which names a space, a configuration, and what alpha is.
struct ColorWords {
    const std::string &space, &config, &alpha;
};

ImageColors image_colors(const std::string& object, const ColorWords& words) {
    constexpr std::pair<const char*, ImageAlpha> kAlphas[] = {{"OPACITY", ImageAlpha::Opacity},
                                                              {"MULTIPLIED", ImageAlpha::Multiplied},
                                                              {"SEPARATE", ImageAlpha::Separate},
                                                              {"IGNORED", ImageAlpha::Ignored}};
    const ImageAlpha alpha = named(object, "alpha", words.alpha, kAlphas);
    if (words.config.empty()) return {color_space(object, words.space), alpha};
    return {std::make_shared<const ColorTransform>(object, words.config, words.space), alpha};
}

/// What a scene holds of a program, which may grow later, and while others render.
std::shared_ptr<const Program> copy_of(const std::shared_ptr<Program>& program) {
    return program ? std::make_shared<const Program>(*program) : nullptr;
}

int add_mesh(SceneDescription& scene, const std::string& name, const Array<float>& vertices,
             const Array<int32_t>& triangles, const std::optional<Array<float>>& corner_normals,
             const std::optional<Array<int32_t>>& material_slots, int uv,
             const std::optional<std::map<int, Array<float>>>& attributes,
             const std::optional<Array<float>>& moved_vertices, const std::optional<Array<float>>& moved_normals) {
    check_shape(name, "vertices", vertices, {-1, 3});
    check_shape(name, "triangles", triangles, {-1, 3});
    const py::ssize_t count = triangles.shape(0);
    TriangleMeshArrays arrays;
    arrays.name = name;
    arrays.vertices = span_of(vertices);
    arrays.triangles = span_of(triangles);
    if (corner_normals) {
        check_shape(name, "corner_normals", *corner_normals, {count, 3, 3});
        arrays.corner_normals = span_of(*corner_normals);
    }
    if (material_slots) {
        check_shape(name, "material_slots", *material_slots, {count});
        arrays.material_slots = span_of(*material_slots);
    }
    if (moved_vertices) {
        check_shape(name, "moved_vertices", *moved_vertices, {-1, vertices.shape(0), 3});
        arrays.moved_vertices = span_of(*moved_vertices);
    }
    if (moved_normals) {
        check_shape(name, "moved_normals", *moved_normals,
                    {moved_vertices ? moved_vertices->shape(0) : 0, count, 3, 3});
        arrays.moved_normals = span_of(*moved_normals);
    }
    arrays.active_uv = uv;
    if (attributes) arrays.attributes = corner_attributes(name, *attributes, count);
    return scene.add_shape(std::make_shared<const TriangleMesh>(std::move(arrays)));
}

int add_surface(SceneDescription& scene, const std::string& name, const std::vector<NurbsSpline>& splines,
                const std::vector<std::vector<NurbsSpline>>& moved_splines) {
    return scene.add_shape(std::make_shared<const PatchSurface>(name, splines, moved_splines));
}

int add_curve(SceneDescription& scene, const SweptCurve& curve) {
    std::shared_ptr<const Shape> surface;
    {
        const py::gil_scoped_release others_may_run;
        surface = curve.surface();
    }
    return scene.add_shape(std::move(surface));
}

using DisplacementTuple = std::optional<std::tuple<std::shared_ptr<Program>, int, int>>;

Material material_of(const std::string& name, const std::shared_ptr<Program>& surface, int pass_index,
                     const std::optional<VolumeVisualisation>& volume, const DisplacementTuple& displacement,
                     const std::shared_ptr<Program>& medium, bool transparent_shadow) {
    Material material{
        name, copy_of(surface), static_cast<float>(pass_index), volume, {}, copy_of(medium), transparent_shadow};
    if (displacement) {
        const auto& [program, object, world] = *displacement;
        if (!program) throw InputError(name, "displacement", "without a program", "(program, register, register)");
        material.displacement = {copy_of(program), object, world};
    }
    return material;
}

int add_material(SceneDescription& scene, const std::string& name, const std::shared_ptr<Program>& surface,
                 int pass_index, const std::optional<VolumeVisualisation>& volume,
                 const DisplacementTuple& displacement, const std::shared_ptr<Program>& medium,
                 bool transparent_shadow) {
    return scene.add_material(material_of(name, surface, pass_index, volume, displacement, medium, transparent_shadow));
}

void change_material(SceneDescription& scene, int index, const std::string& name,
                     const std::shared_ptr<Program>& surface, int pass_index,
                     const std::optional<VolumeVisualisation>& volume, const DisplacementTuple& displacement,
                     const std::shared_ptr<Program>& medium, bool transparent_shadow) {
    replace_material(scene, index,
                     material_of(name, surface, pass_index, volume, displacement, medium, transparent_shadow));
}

std::shared_ptr<Shape> shape_of(const SceneDescription& scene, int index) {
    if (index < 0 || static_cast<size_t>(index) >= scene.shapes.size())
        throw InputError("scene", "shape", std::to_string(index),
                         "an index from 0 to " + std::to_string(static_cast<int>(scene.shapes.size()) - 1));
    // Python sees nothing that could change it.
    return std::const_pointer_cast<Shape>(scene.shapes[static_cast<size_t>(index)]);
}

void move_instances(SceneDescription& scene, const Array<int32_t>& indices, const Array<double>& matrices) {
    check_shape("instances", "indices", indices, {-1});
    check_shape("instances", "matrices", matrices, {indices.shape(0), 4, 4});
    std::vector<Affine3d> places;
    for (py::ssize_t i = 0; i < indices.shape(0); ++i)
        places.push_back(affine_of("instances", matrices.data() + 16 * i));
    place_instances(scene, span_of(indices), places);
}

int add_lamp(SceneDescription& scene, const std::string& name, const std::string& kind, const Array<double>& matrix,
             const std::array<float, 3>& strength, double radius, bool soft_falloff, double angle, double spot_size,
             double spot_blend, const std::string& spot_profile, double size_x, double size_y, double spread,
             bool casts_shadow, int visibility, const std::shared_ptr<Program>& emission, int light_group,
             std::pair<int, int> link) {
    Lamp lamp;
    lamp.name = name;
    lamp.kind = lamp_kind(name, kind);
    lamp.to_world = affine_of(name, matrix);
    lamp.strength = Color(strength[0], strength[1], strength[2]);
    lamp.radius = radius;
    lamp.soft_falloff = soft_falloff;
    lamp.angle = angle;
    lamp.spot_size = spot_size;
    lamp.spot_blend = spot_blend;
    lamp.spot_profile = spot_profile_of(name, spot_profile);
    lamp.size_x = size_x;
    lamp.size_y = size_y;
    lamp.spread = spread;
    lamp.casts_shadow = casts_shadow;
    lamp.visibility = visibility_of(name, visibility);
    lamp.emission = copy_of(emission);
    lamp.light_group = light_group;
    lamp.link = checked_light_link(name, link.first, link.second);
    return scene.add_lamp(lamp);
}

void set_world(SceneDescription& scene, const std::shared_ptr<Program>& world, int sampling_resolution,
               const std::shared_ptr<Program>& medium, int light_group, int visibility, int64_t lit_by) {
    scene.world_lit_by = checked_light_sets("world", lit_by);
    scene.world_visibility = visibility_of("world", visibility);
    scene.set_world_light_group(light_group);
    scene.set_world(copy_of(world), sampling_resolution, copy_of(medium));
}

void set_camera(SceneDescription& scene, const std::string& kind, const Array<double>& matrix,
                std::pair<double, double> window_min, std::pair<double, double> window_max, double clip_start,
                double clip_end, double aperture_radius, double focus_distance, int blades, double blade_rotation,
                double aperture_ratio, bool dicing, const std::optional<Panorama>& panorama,
                const std::optional<Array<double>>& motion, const std::optional<Array<double>>& windows,
                const std::optional<Array<float>>& shutter_curve, std::optional<double> rolling_shutter) {
    constexpr std::pair<const char*, CameraKind> kKinds[] = {{"PERSPECTIVE", CameraKind::Perspective},
                                                             {"ORTHOGRAPHIC", CameraKind::Orthographic},
                                                             {"PANORAMIC", CameraKind::Panoramic}};
    CameraDescription camera;
    camera.kind = named("camera", "kind", kind, kKinds);
    if (panorama) camera.panorama = *panorama;
    camera.to_world = affine_of("camera", matrix);
    camera.window_min = Vec2d(window_min.first, window_min.second);
    camera.window_max = Vec2d(window_max.first, window_max.second);
    camera.clip_start = clip_start;
    camera.clip_end = clip_end;
    camera.aperture_radius = aperture_radius;
    camera.focus_distance = focus_distance;
    camera.blades = blades;
    camera.blade_rotation = blade_rotation;
    camera.aperture_ratio = aperture_ratio;
    if (motion) camera.motion = places_of("camera", *motion);
    if (windows) camera.windows = windows_of(*windows);
    if (shutter_curve) {
        check_shape("camera", "shutter curve", *shutter_curve, {-1});
        camera.shutter.curve.assign(shutter_curve->data(), shutter_curve->data() + shutter_curve->size());
    }
    camera.shutter.rolling = rolling_shutter;
    dicing ? scene.set_dicing_camera(camera) : scene.set_camera(camera);
}

std::map<std::string, std::string> manifest(const SceneDescription& scene, const std::string& kind,
                                            const std::string& layer) {
    constexpr std::pair<const char*, MatteKind> kKinds[] = {
        {"OBJECT", MatteKind::Object}, {"MATERIAL", MatteKind::Material}, {"ASSET", MatteKind::Asset}};
    return scene.matte_attributes(named("scene", "kind", kind, kKinds), layer);
}

Panorama make_panorama(const std::string& kind, std::pair<double, double> longitudes,
                       std::pair<double, double> latitudes, double field_of_view, double lens,
                       std::pair<double, double> sensor, double eye_offset, std::optional<double> convergence,
                       std::optional<std::pair<double, double>> pole_merge) {
    constexpr std::pair<const char*, PanoramaKind> kKinds[] = {
        {"EQUIRECTANGULAR", PanoramaKind::Equirectangular},
        {"FISHEYE_EQUIDISTANT", PanoramaKind::FisheyeEquidistant},
        {"FISHEYE_EQUISOLID", PanoramaKind::FisheyeEquisolid},
        {"MIRRORBALL", PanoramaKind::MirrorBall}};
    const Panorama panorama{named("camera", "panorama", kind, kKinds),
                            longitudes.first,
                            longitudes.second,
                            latitudes.first,
                            latitudes.second,
                            field_of_view,
                            lens,
                            sensor.first,
                            sensor.second,
                            {eye_offset, convergence, pole_merge}};
    validate(panorama);
    return panorama;
}

// Large images take long, even though most is done by other threads; Python goes on meanwhile.
int add_image_file(SceneDescription& scene, const std::string& name, const std::string& path, const std::string& space,
                   const std::string& config, int picture, const std::string& alpha) {
    if (picture < 0) throw InputError(name, "picture", std::to_string(picture), "0 or more");
    const py::gil_scoped_release released;
    return scene.textures()->add_file(name, path, image_colors(name, {space, config, alpha}), picture);
}

int add_packed_image(SceneDescription& scene, const std::string& name, const py::bytes& content,
                     const std::string& space, const std::string& config, const std::string& alpha) {
    const std::string_view bytes = content;
    const py::gil_scoped_release released;
    return scene.textures()->add_packed(name, std::as_bytes(std::span(bytes)),
                                        image_colors(name, {space, config, alpha}));
}

int add_image_pixels(SceneDescription& scene, const std::string& name, const Array<float>& pixels,
                     const std::string& space, const std::string& config, const std::string& alpha) {
    check_shape(name, "pixels", pixels, {-1, -1, -1});
    const auto height = static_cast<int>(pixels.shape(0)), width = static_cast<int>(pixels.shape(1));
    const auto channels = static_cast<int>(pixels.shape(2));
    const std::span<const float> values = span_of(pixels);
    const py::gil_scoped_release released;
    return scene.textures()->add_pixels(name, values, width, height, channels,
                                        image_colors(name, {space, config, alpha}));
}

std::vector<std::pair<std::string, std::string>> leave_out_unreadable_images(SceneDescription& scene) {
    const py::gil_scoped_release released;
    std::vector<std::pair<std::string, std::string>> found;
    if (const std::shared_ptr<TextureStore>& textures = scene.existing_textures())
        for (TextureStore::Unreadable& image : textures->leave_out_unreadable(kNeverCancelled))
            found.emplace_back(std::move(image.name), std::move(image.reason));
    return found;
}

}  // namespace

void bind_scene(py::module_& module) {
    using namespace py::literals;
    py::class_<SceneParts, std::shared_ptr<SceneParts>>(
        module, "SceneParts",
        "What renders of like scenes share: shapes built for tracing, converted textures, the world's table.")
        .def(py::init<>());
    constexpr double kHalf = std::numbers::pi, kQuarter = kHalf / 2;
    py::class_<Panorama>(module, "Panorama",
                         "What a panoramic camera shows; angles in radians, lengths in millimetres.")
        .def(py::init(&make_panorama), "kind"_a, "longitudes"_a = std::make_pair(-kHalf, kHalf),
             "latitudes"_a = std::make_pair(-kQuarter, kQuarter), "field_of_view"_a = kHalf, "lens"_a = 10.5,
             "sensor"_a = std::make_pair(36.0, 24.0), "eye_offset"_a = 0.0, "convergence"_a = py::none(),
             "pole_merge"_a = py::none());
    SceneClass described(
        module, "SceneDescription",
        "A scene. Each add_... returns an index for later calls, or raises and leaves the scene as it was.");
    bind_instances(described);
    described.def(py::init<std::shared_ptr<SceneParts>>(), "parts"_a = py::none())
        .def("attribute", &SceneDescription::attribute, "name"_a)
        .def("add_mesh", &add_mesh, "name"_a, "vertices"_a, "triangles"_a, "corner_normals"_a = py::none(),
             "material_slots"_a = py::none(), "uv"_a = -1, "attributes"_a = py::none(), "moved_vertices"_a = py::none(),
             "moved_normals"_a = py::none())
        .def("add_surface", &add_surface, "name"_a, "splines"_a,
             "moved_splines"_a = std::vector<std::vector<NurbsSpline>>())
        .def(
            "add_shape",
            [](SceneDescription& scene, const std::shared_ptr<Shape>& shape) { return scene.add_shape(shape); },
            py::arg("shape").none(false))
        .def("add_curve", &add_curve, "curve"_a)
        .def("add_material", &add_material, "name"_a, "surface"_a.none(true), "pass_index"_a = 0,
             "volume"_a = py::none(), "displacement"_a = py::none(), "medium"_a = py::none(),
             "transparent_shadow"_a = true)
        .def("copy", [](const SceneDescription& scene) { return std::make_shared<SceneDescription>(scene); })
        .def("emptied",
             [](const SceneDescription& scene) { return std::make_shared<SceneDescription>(emptied(scene)); })
        .def(
            "shows_same_as",
            [](const SceneDescription& scene, const std::shared_ptr<SceneDescription>& other) {
                return shows_same(scene, *other);
            },
            py::arg("other").none(false))
        .def("shape", &shape_of, "index"_a)
        .def(
            "set_texture_space",
            [](const SceneDescription& scene, int index, const std::array<double, 3>& low,
               const std::array<double, 3>& high) {
                shape_of(scene, index)
                    ->set_texture_space({Vec3d(low[0], low[1], low[2]), Vec3d(high[0], high[1], high[2])});
            },
            "shape"_a, "low"_a, "high"_a)
        .def(
            "replace_shape",
            [](SceneDescription& scene, int index, const std::shared_ptr<Shape>& shape) {
                replace_shape(scene, index, shape);
            },
            "index"_a, py::arg("shape").none(false))
        .def("replace_material", &change_material, "index"_a, "name"_a, "surface"_a.none(true), "pass_index"_a = 0,
             "volume"_a = py::none(), "displacement"_a = py::none(), "medium"_a = py::none(),
             "transparent_shadow"_a = true)
        .def("place_instances", &move_instances, "indices"_a, "matrices"_a)
        .def("clear_lamps", [](SceneDescription& scene) { scene.lamps.clear(); })
        .def("add_material_list", &SceneDescription::add_material_list, "materials"_a)
        .def("add_ray_interpolation", &SceneDescription::add_ray_interpolation, "object"_a, "interpolation"_a)
        .def("add_lamp", &add_lamp, "name"_a, "kind"_a, "matrix"_a, "strength"_a, "radius"_a = 0.0,
             "soft_falloff"_a = false, "angle"_a = 0.0, "spot_size"_a = 0.0, "spot_blend"_a = 0.0,
             "spot_profile"_a = "COSINE", "size_x"_a = 1.0, "size_y"_a = 1.0, "spread"_a = std::numbers::pi,
             "casts_shadow"_a = true, "visibility"_a = kVisibleAll | kOfFootage, "emission"_a = py::none(),
             "light_group"_a = -1, "link"_a = std::make_pair(-1, -1))
        .def("set_world", &set_world, "world"_a.none(true), "sampling_resolution"_a = 1024, "medium"_a = py::none(),
             "light_group"_a = -1, "visibility"_a = static_cast<int>(kVisibleAll), "lit_by"_a = kAnyLight)
        .def("matte_attributes", &manifest, "kind"_a, "layer"_a)
        .def("set_camera", &set_camera, "kind"_a, "matrix"_a, "window_min"_a, "window_max"_a, "clip_start"_a,
             "clip_end"_a, "aperture_radius"_a = 0.0, "focus_distance"_a = 10.0, "blades"_a = 0,
             "blade_rotation"_a = 0.0, "aperture_ratio"_a = 1.0, "dicing"_a = false, "panorama"_a = py::none(),
             "motion"_a = py::none(), "windows"_a = py::none(), "shutter_curve"_a = py::none(),
             "rolling_shutter"_a = py::none())
        .def("add_image_file", &add_image_file, "name"_a, "path"_a, "color_space"_a, "config"_a = "", "picture"_a = 0,
             "alpha"_a = "OPACITY")
        .def("add_packed_image", &add_packed_image, "name"_a, "content"_a, "color_space"_a, "config"_a = "",
             "alpha"_a = "OPACITY")
        .def("leave_out_unreadable_images", &leave_out_unreadable_images)
        .def("add_image_pixels", &add_image_pixels, "name"_a, "pixels"_a, "color_space"_a, "config"_a = "",
             "alpha"_a = "OPACITY")
        .def_readwrite("texture_memory", &SceneDescription::texture_memory);
}

}  // namespace rayleaf
