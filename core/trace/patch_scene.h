// A surface of patches as Embree's user geometry: one primitive a subpatch, its box that of its grid's vertices.
#pragma once

#include "geometry/patch_surface.h"
#include "tessellation/grid_intersection.h"
#include "tessellation/tessellation_store.h"
#include "trace/shape_scene.h"

#include <vector>

namespace rayleaf {

class PatchScene final : public ShapeScene {
  public:
    PatchScene(const PatchSurface& surface, const FacetTolerance& tolerance, const CancelToken& cancel);

    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override;
    uint64_t subpatch_count() const override { return store_.subpatch_count(); }
    uint64_t grids_diced() const override { return store_.diced(); }
    NormalCounters limit_normals() const override { return surface_->limit_normals(); }
    uint64_t grid_bytes() const override { return store_.bytes(); }

    const TessellationStore& store() const { return store_; }

  private:
    const PatchSurface* surface_;
    TessellationStore store_;
    AddCandidates add_candidates_;
    std::vector<Box3f> boxes_;  ///< while the scene is built

    bool visit(ShapeQuery& query, uint32_t subpatch, float t_max) const;

    static void bounds_callback(const RTCBoundsFunctionArguments* arguments);
    static void closest_callback(const RTCIntersectFunctionNArguments* arguments);
    static void any_callback(const RTCOccludedFunctionNArguments* arguments);
};

}  // namespace rayleaf
