// The media of a scene: which objects hold one, and what it is like at a point.
#pragma once

#include "scene/description.h"
#include "scene/grid_majorants.h"
#include "scene/scene_medium.h"
#include "shading/inputs.h"
#include "trace/tracer.h"

#include <map>
#include <span>
#include <utility>
#include <vector>

namespace rayleaf {

class SceneMedia {
  public:
    /// What evaluating a medium needs of the scene; it must stay.
    struct Surroundings {
        const Tracer* tracer = nullptr;
        const std::vector<InstanceInfo>* instances = nullptr;
        const CameraInfo* camera = nullptr;
        const TextureStore* textures = nullptr;
    };

    bool empty() const { return all_.empty() && !world_.program; }
    /// `world`: what fills all of space; null: nothing.
    void set_surroundings(const Surroundings& surroundings, std::shared_ptr<const Program> world);
    /// Of an instance that has a material with a medium.
    void add(uint32_t instance, const Material& material);
    /// After all were added: bounds those that vary. Throws Cancelled soon after `cancel` says so.
    void commit(const CancelToken& cancel);

    /// Null where the material has none.
    const SceneMedium* find(uint32_t instance, const Material& material) const;
    /// What fills all of space; null: nothing.
    const SceneMedium* world() const { return world_.program ? &world_ : nullptr; }
    /// Instances with a medium, each once.
    std::span<const uint32_t> instances() const { return instances_; }

    /// What a medium does at a world point to light towards `outgoing` (unit): `medium` and `emission` of the result.
    void evaluate(const SceneMedium& medium, const Vec3d& position, const Vec3f& outgoing, const PathState& path,
                  Closures& result) const;
    /// World to the space of a medium's grid.
    Affine3d to_grid(const SceneMedium& medium) const;

  private:
    using Key = std::pair<uint32_t, const Program*>;

    Surroundings surroundings_;
    std::shared_ptr<const Program> world_program_;
    SceneMedium world_;
    std::map<Key, SceneMedium> all_;
    std::vector<uint32_t> instances_;

    SurfacePoint point_in(const SceneMedium& medium, const Vec3d& position, const Vec3f& outgoing) const;
    ShadingInputs inputs_at(const SceneMedium& medium, const SurfacePoint& point, const PathState& path) const;
    bool is_empty_at(const SceneMedium& medium, const SurfacePoint& point) const;
    void look_up(const SceneMedium& medium, std::span<const GridProbe> probes, FoundDensity* found) const;
    void note_if_even(SceneMedium& medium) const;
    void bound(SceneMedium& medium, int cells, const CancelToken& cancel) const;
};

}  // namespace rayleaf
