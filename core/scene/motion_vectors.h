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
    std::vector<std::shared_ptr<const Motion>> motions_;  ///< by instance; null: it stands still
};

}  // namespace rayleaf
