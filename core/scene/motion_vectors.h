// The Vector pass: how far surface points move in the picture from frame to frame.
#pragma once

#include "scene/camera.h"
#include "scene/description.h"
#include "scene/settings.h"

#include <memory>
#include <vector>

namespace rayleaf {

/// Whether the settings ask for vectors: then motions say where things are one frame before (time 0) and one after
/// (time 1), and the picture itself is sharp.
bool wants_vectors(const Settings& settings);

class MotionVectors {
  public:
    MotionVectors(const SceneDescription& description, const Settings& settings);

    /// Pixels, as in film/passes.def.
    Vec4f at(const SurfacePoint& point) const;

  private:
    Camera camera_;
    /// Of an instance.
    struct Moving {
        std::shared_ptr<const Motion> motion;  ///< null: it stands still
        std::shared_ptr<const Shape> shape;    ///< null: it does not deform
        Affine3d object_to_world;
    };
    std::vector<Moving> instances_;

    Vec3d place(const SurfacePoint& point, float time) const;
};

}  // namespace rayleaf
