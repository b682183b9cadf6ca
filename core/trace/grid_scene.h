// A surface that is diced, as Embree's user geometry: one primitive a subpatch, its box that of its grid's vertices.
#pragma once

#include "tessellation/grid_intersection.h"
#include "tessellation/tessellation_store.h"
#include "trace/shape_scene.h"

#include <memory>
#include <vector>

namespace rayleaf {

class GridScene final : public ShapeScene {
  public:
    GridScene(const Shape& shape, std::unique_ptr<const Dicer> dicer, const CancelToken& cancel);

    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override;
    /// Fixed numbers are tested in double: rounded as often as in single precision, and a few times more in the test.
    double float_error() const override {
        return store_.dicer().format() == VertexFormat::Fixed ? 0x1p-49 : ShapeScene::float_error();
    }
    uint64_t subpatch_count() const override { return store_.subpatch_count(); }
    uint64_t grids_diced() const override { return store_.diced(); }
    NormalCounters limit_normals() const override;
    uint64_t grid_bytes() const override { return store_.bytes(); }

    const TessellationStore& store() const { return store_; }

  private:
    TessellationStore store_;
    AddCandidates add_candidates_;
    std::vector<Box3f> boxes_;  ///< while the scene is built

    bool visit(ShapeQuery& query, uint32_t subpatch, float t_max) const;

    static void bounds_callback(const RTCBoundsFunctionArguments* arguments);
    static void closest_callback(const RTCIntersectFunctionNArguments* arguments);
    static void any_callback(const RTCOccludedFunctionNArguments* arguments);
};

}  // namespace rayleaf
