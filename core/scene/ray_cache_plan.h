// Which objects of a scene can have a ray cache, of what kind, and which share one.
#pragma once

#include "base/cancel.h"
#include "ri_tree/sample_tracer.h"
#include "scene/material_optics.h"
#include "scene/ray_interpolation.h"
#include "scene/settings.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rayleaf {

class Scene;

/// One cache: of a shape, by what its material makes of rays and by its settings.
struct PlannedRayCache {
    std::shared_ptr<const Shape> shape;
    SampleSettings samples;
    RayInterpolation interpolation;
    std::vector<uint32_t> instances;
    std::vector<std::string> objects;  ///< names of the first few instances
    std::string obstacle;              ///< why there can be none; empty: there can
    bool first_hits_only = false;      ///< of glass: rays do not skip its inside (Scene::glass_body)
};

/// How many hits from inside a path through glass may have before the limits of bounces end it, wherever it came from:
/// it entered by one bounce, and all hits but the last are reflections.
int most_interior_hits(const Settings& settings);

/// Objects whose interpolation is off are not listed. A material that reads texture coordinates wants them stored, and
/// the UV pass those of every surface: then there are first hits alone. Throws Cancelled soon after `cancel` says so.
std::vector<PlannedRayCache> plan_ray_caches(const SceneDescription& description, const Scene& scene,
                                             const Settings& settings, const CancelToken& cancel);

/// The glass body of an instance that is clear glass all over and whose map is rigid but for an even scale: where
/// nothing else lies in its box (scene/occupancy.h), rays through it may skip its inside.
std::optional<GlassBody> glass_body_of(const Scene& scene, uint32_t instance);

}  // namespace rayleaf
