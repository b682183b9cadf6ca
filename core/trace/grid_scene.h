// A surface whose facets go through the geometry cache, as Embree's user geometry: one primitive a subpatch, its box
// that of its vertices at all levels.
#pragma once

#include "tessellation/dicer.h"
#include "tessellation/grid_intersection.h"
#include "tessellation/step_intersection.h"
#include "trace/diced_surface.h"
#include "trace/shape_scene.h"

#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

class GridScene final : public ShapeScene {
  public:
    GridScene(const Shape& shape, DicedSurface surface, const CancelToken& cancel);

    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override;
    uint32_t subpatch_count() const override { return dicer_->subpatch_count(); }
    uint32_t cached_subpatches() const override { return dicer_->subpatch_count(); }
    /// Double precision decides: rounded as often as in single precision, and a few times more in the test.
    double float_error() const override { return 0x1p-49; }
    double vertex_error() const override { return kFinestTolerance; }
    NormalCounters limit_normals() const override { return normal_counters(shape()); }
    uint64_t record_bytes() const override;

  private:
    std::unique_ptr<const Dicer> dicer_;
    GridKernels kernels_;
    StepKernels step_kernels_;
    double step_ = 0;                      ///< of vertices in fixed numbers as the kernels take them
    bool in_steps_ = false;                ///< grids are StepGrid
    std::vector<SubpatchDetail> details_;  ///< none where the dicer has no levels
    /// Of subpatches without levels, where testing it before a grid lookup saves time.
    std::vector<SubpatchBounds::Tube> tubes_;
    std::vector<Box3f> boxes_;  ///< while the scene is built

    struct PartSearch;
    bool fits_steps() const;
    void prepare(ShapeQuery& query) const override;
    void keep_tubes(std::vector<SubpatchBounds::Tube> tubes);
    bool visit(ShapeQuery& query, uint32_t subpatch, float t_max) const;
    bool offer_facets(ShapeQuery& query, const SnappedGrid& grid, uint32_t subpatch, const SubpatchLevels& levels,
                      float t_max) const;
    bool offer_fixed(ShapeQuery& query, uint32_t subpatch, float t_max) const;
    bool offer_steps(ShapeQuery& query, uint32_t subpatch, float t_max) const;
    FacetCorners fine_corners(const GeometryCache::Reader& reader, uint32_t subpatch, uint32_t triangle) const;
    bool visit_parts(PartSearch& search, const Grid& grid, const GridPart& place) const;
    bool offer_part(PartSearch& search, const Grid& grid, const GridPart& place) const;

    static void bounds_callback(const RTCBoundsFunctionArguments* arguments);
    static void closest_callback(const RTCIntersectFunctionNArguments* arguments);
    static void any_callback(const RTCOccludedFunctionNArguments* arguments);
};

}  // namespace rayleaf
