// The way each kind of shape is traced.
#pragma once

#include "tessellation/facet_blocks.h"
#include "trace/diced_surface.h"
#include "trace/shape_scene.h"

#include <memory>
#include <optional>
#include <vector>

namespace rayleaf {

/// Whether a diced shape's facets stay in memory or go through the geometry cache.
enum class Residence : uint8_t { Resident, Cached };

/// A shape that has been measured but not yet built.
struct ShapePlan {
    const Shape* shape = nullptr;
    std::vector<DicedSurface> forms;    ///< of shapes that are diced, at each of their steps
    std::optional<FacetBlocks> blocks;  ///< its facets as they would be resident
    double facet_distance = 0;          ///< see ShapeScene::facet_distance

    /// Bytes that a resident shape takes more than a cached one; 0 for shapes that are not diced.
    uint64_t resident_bytes() const;
};
/// The tolerance is for shapes that are diced. Throws Cancelled soon after `cancel` says so.
ShapePlan plan_shape(const Shape& shape, const FacetTolerance& tolerance, WaitingGrids& waiting,
                     const CancelToken& cancel);
std::unique_ptr<ShapeScene> make_scene(ShapePlan plan, Residence residence, const CancelToken& cancel);

/// Which of the shapes stay in memory: those whose facets cost the least for each instance, as long as the budget
/// lasts. `bytes` are their plans' resident_bytes.
std::vector<Residence> choose_residents(std::span<const uint64_t> bytes, std::span<const uint32_t> instances,
                                        uint64_t budget);

}  // namespace rayleaf
