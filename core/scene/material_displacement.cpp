#include "scene/material_displacement.h"

#include "base/error.h"
#include "base/maybe.h"
#include "scene/scene_parts.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace rayleaf {
namespace {

class ByMaterial final : public Displacement {
  public:
    ByMaterial(std::vector<Material> slots, const InstanceInfo& instance, const DisplacementSurroundings& surroundings,
               const LocalFrame& frame)
        : slots_(std::move(slots)),
          instance_(instance),
          surroundings_(surroundings),
          map_(instance.object_to_world * frame.to_object()),
          side_(map_.determinant() < 0.0 ? -1.0 : 1.0) {}

    std::optional<ContentHash> content_hash() const override {
        ContentHasher hasher;
        for (const Material& material : slots_) add_to(hasher, material);
        add_to(hasher, instance_);
        if (surroundings_.textures) surroundings_.textures->add_to(hasher);
        const auto reads_camera = [](const Material& material) {
            return material.displacement.program && material.displacement.program->reads_camera();
        };
        if (surroundings_.camera && std::any_of(slots_.begin(), slots_.end(), reads_camera))
            surroundings_.camera->add_to(hasher);
        return hasher.value();
    }

    void offsets(const Shape& base, std::span<const PlacedPoint> points, Vec3d* offsets) const override {
        for (size_t first = 0; first < points.size();) {
            const size_t slot = slot_of(base, points[first]);
            size_t end = first + 1;
            while (end < points.size() && end - first < kMostPoints && slot_of(base, points[end]) == slot) ++end;
            add_offsets(slots_[slot], base, points.subspan(first, end - first), offsets + first);
            first = end;
        }
    }

  private:
    std::vector<Material> slots_;
    InstanceInfo instance_;
    DisplacementSurroundings surroundings_;
    Affine3d map_;  ///< local space of the surface below -> world
    double side_;   ///< a mirrored object's outside stays its outside

    static void add_to(ContentHasher& hasher, const Material& material) {
        const MaterialDisplacement& displacement = material.displacement;
        hasher.add(displacement.program ? 1 : 0);
        if (!displacement.program) return;
        displacement.program->add_to(hasher);
        hasher.add(displacement.object);
        hasher.add(displacement.world);
        hasher.add(double{material.pass_index});
    }

    static void add_to(ContentHasher& hasher, const InstanceInfo& instance) {
        hasher.add(instance.object_to_world);
        hasher.add(double{instance.object_index});
        hasher.add(double{instance.random});
        for (const InstanceAttribute& attribute : instance.attributes) {
            hasher.add(attribute.id);
            for (const float number : attribute.value) hasher.add(double{number});
        }
    }

    size_t slot_of(const Shape& base, const PlacedPoint& point) const {
        return std::min<size_t>(base.material_slot(point.hit), slots_.size() - 1);
    }

    void set_point(const Shape& base, const PlacedPoint& placed, SurfacePoint& point) const {
        const LocalSurface& surface = placed.surface;
        point.position = point.facet_position = map_.point(surface.position);
        point.normal = Vec3f(normalized_or(map_.normal(Vec3d(surface.normal)) * side_, Vec3d(0, 0, 1)));
        point.facet_normal = point.normal;
        point.dp_du = Vec3f(map_.vector(Vec3d(surface.dp_du)));
        point.dp_dv = Vec3f(map_.vector(Vec3d(surface.dp_dv)));
        point.uv = surface.uv;
        point.shape = &base;
        point.local = placed.hit;
    }

    /// Of at most kMostPoints points of one material.
    void add_offsets(const Material& material, const Shape& base, std::span<const PlacedPoint> placed,
                     Vec3d* offsets) const {
        std::fill_n(offsets, placed.size(), Vec3d(0.0));
        const MaterialDisplacement& displacement = material.displacement;
        if (!displacement.program) return;
        std::array<Maybe<SurfacePoint>, kMostPoints> points;
        std::array<Maybe<ShadingInputs>, kMostPoints> inputs;
        std::array<const ShadingInputs*, kMostPoints> asked;
        for (size_t i = 0; i < placed.size(); ++i) {
            set_point(base, placed[i], points[i].emplace());
            ShadingInputs& input = inputs[i].emplace();
            input.point = &*points[i];
            input.instance = &instance_;
            input.camera = surroundings_.camera ? &*surroundings_.camera : nullptr;
            input.textures = surroundings_.textures.get();
            input.outgoing = input.point->normal;
            input.material_index = material.pass_index;
            asked[i] = &input;
        }
        const auto add = [&](Register target, const auto& in_object) {
            if (target < 0) return;
            std::array<Vec4f, kMostPoints> values;
            displacement.program->values(target, {asked.data(), placed.size()}, values.data());
            for (size_t i = 0; i < placed.size(); ++i)
                offsets[i] += in_object(Vec3d(values[i].x, values[i].y, values[i].z));
        };
        add(displacement.object, [](const Vec3d& v) { return v; });
        add(displacement.world, [&](const Vec3d& v) { return instance_.world_to_object.vector(v); });
    }
};

std::vector<Material> materials_of(const SceneDescription& description, const std::vector<int>& list) {
    std::vector<Material> slots;
    for (const int material : list) {
        const bool known = material >= 0 && static_cast<size_t>(material) < description.materials.size();
        slots.push_back(known ? description.materials[static_cast<size_t>(material)] : Material{});
    }
    return slots;
}

/// All that a displacement may depend on.
using DisplacementLook = std::tuple<const Shape*, const std::vector<int>*, std::array<double, 12>, float, float,
                                    std::vector<InstanceAttribute>>;

DisplacementLook look_of(const Shape* shape, const std::vector<int>* list, const InstanceDescription& instance) {
    const Affine3d& m = instance.object_to_world;
    return {shape,
            list,
            {m.x.x, m.x.y, m.x.z, m.y.x, m.y.y, m.y.z, m.z.x, m.z.y, m.z.z, m.translation.x, m.translation.y,
             m.translation.z},
            instance.object_index,
            instance.random,
            instance.attributes};
}

/// Such a surface of the store, or a new one, which is kept there.
std::shared_ptr<const Shape> found_or_made(const std::shared_ptr<const Shape>& base,
                                           std::shared_ptr<const Displacement> displacement,
                                           DisplacedSurfaceStore& store, const CancelToken& cancel) {
    const std::optional<ContentHash> key = DisplacedSurface::hash_of(*base, *displacement);
    std::shared_ptr<const Shape> surface = key ? store.find(*key) : nullptr;
    if (surface) return surface;
    surface = std::make_shared<const DisplacedSurface>(base, std::move(displacement), cancel);
    if (key) store.keep(*key, surface);
    return surface;
}

}  // namespace

void displace(ChunkedVector<TracedInstance>& traced, const SceneDescription& description,
              const std::function<const std::vector<int>&(uint32_t)>& list_of,
              const DisplacementSurroundings& surroundings, const CancelToken& cancel) {
    const auto is_displacing = [](const Material& material) { return material.displacement.program != nullptr; };
    if (std::none_of(description.materials.begin(), description.materials.end(), is_displacing)) return;
    const auto displaces = [&](int material) {
        return material >= 0 && static_cast<size_t>(material) < description.materials.size() &&
               is_displacing(description.materials[static_cast<size_t>(material)]);
    };
    description.parts->displaced.next_user();
    std::map<DisplacementLook, std::shared_ptr<const Shape>> known;
    for (uint32_t i = 0; i < traced.size(); ++i) {
        const std::vector<int>& list = list_of(i);
        const std::shared_ptr<const Shape> shape = traced[i].shape;
        if (!DisplacedSurface::can_displace(*shape) || std::none_of(list.begin(), list.end(), displaces)) continue;
        const InstanceDescription& instance = description.instances[i];
        std::shared_ptr<const Shape>& made = known[look_of(shape.get(), &list, instance)];
        if (!made) {
            const InstanceInfo info{instance.object_to_world, instance.object_to_world.inverse(), instance.object_index,
                                    instance.random, instance.attributes};
            made = found_or_made(
                shape,
                std::make_shared<const ByMaterial>(materials_of(description, list), info, surroundings, shape->frame()),
                description.parts->displaced, cancel);
        }
        traced.edit(i).shape = made;
    }
}

std::shared_ptr<Shape> displaced(std::shared_ptr<const Shape> shape, const MaterialDisplacement& displacement) {
    if (!DisplacedSurface::can_displace(*shape))
        throw InputError(shape->name(), "shape", "neither a spline surface nor a subdivision surface", "one of these");
    check_displacement(shape->name(), displacement);
    Material material;
    material.displacement = displacement;
    auto by_material = std::make_shared<const ByMaterial>(std::vector<Material>{material}, InstanceInfo{},
                                                          DisplacementSurroundings{}, shape->frame());
    return std::make_shared<DisplacedSurface>(std::move(shape), std::move(by_material));
}

}  // namespace rayleaf
