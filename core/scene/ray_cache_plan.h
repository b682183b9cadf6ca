// Which objects of a scene can have a ray cache, of what kind, and which share one.
#pragma once

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
    bool first_hits_only = false;      ///< of glass: rays do not skip its inside (skippable_glass)
};

/// How many hits from inside a path through glass may have before the limits of bounces end it, wherever it came from:
/// it entered by one bounce, and all hits but the last are reflections.
int most_interior_hits(const Settings& settings);

/// Objects whose interpolation is off are not listed. A material that reads texture coordinates wants them stored, and
/// the UV pass those of every surface: then there are first hits alone.
std::vector<PlannedRayCache> plan_ray_caches(const SceneDescription& description, const Scene& scene,
                                             const Settings& settings);

/// The glass body of an instance, where rays through it may skip its inside: its map is rigid but for an even scale,
/// and nothing else lies in its box.
std::optional<GlassBody> skippable_glass(const SceneDescription& description, const Scene& scene, uint32_t instance);

}  // namespace rayleaf
