// A surface whose facets stay in memory: a tree over blocks of 4 x 4 cells.
//
// Every ray sees the same facets, which the view made as fine as it needs: there is no level to choose, nothing to look
// up, and nothing that a ray must know of the one before it.
#pragma once

#include "tessellation/facet_blocks.h"
#include "tessellation/grid_intersection.h"
#include "tessellation/packet_decision.h"
#include "trace/diced_surface.h"
#include "trace/moving_tree.h"
#include "trace/shape_scene.h"

#include <memory>

namespace rayleaf {

class ResidentScene final : public ShapeScene {
  public:
    /// `forms` are the shape's at each of its steps, `blocks` theirs, not yet filled.
    ResidentScene(const Shape& shape, std::vector<DicedSurface> forms, FacetBlocks blocks, const CancelToken& cancel);

    bool closest(const LocalRay& ray, ShapeHit& hit) const override;
    bool occluded(const LocalRay& ray) const override;
    void find_closest(PacketQuery& packet) const override;
    void find_any(PacketQuery& packet) const override;
    bool finds_all() const override { return true; }
    bool find_all(const LocalRay& ray, uint32_t instance, PassedHits& passed) const override;
    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override;
    uint32_t subpatch_count() const override { return dicer_->subpatch_count(); }
    /// As of GridScene: double precision decides.
    double float_error() const override { return 0x1p-49; }
    double vertex_error() const override { return kFinestTolerance; }
    NormalCounters limit_normals() const override { return normal_counters(shape()); }
    uint64_t facet_bytes() const override { return blocks_.bytes(); }
    uint64_t tree_bytes() const override { return tree_.bytes(); }
    uint64_t record_bytes() const override { return dicer_->bytes(); }

  private:
    std::unique_ptr<const Dicer> dicer_;
    GridKernels kernels_;
    PacketKernels packet_kernels_;
    MeetFacets meet_facets_;
    FacetBlocks blocks_;

    MovingTree tree_;  ///< of blocks

    struct Query;
    struct Packet;
    enum class Wanted : uint8_t { Closest, Any };

    BlockVertices vertices(const FacetBlock& block) const;
    bool find(const LocalRay& ray, ShapeHit& hit, Wanted wanted) const;
    void find(PacketQuery& packet, Wanted wanted) const;
    void add_candidates(const FacetBlock& block, const GridRay& ray, float t_max, GridCandidates& candidates) const;
    bool visit(Query& query, uint32_t block, float t_max) const;
    uint32_t visit(PacketQuery& packet, uint32_t block, uint32_t lanes, float* farthest) const;
    uint32_t visit_moving(PacketQuery& packet, uint32_t block, uint32_t lanes, float* farthest) const;
    BoxVisitor visitor(BoxVisitor::Visit visit_block, void* query) const {
        return {visit_block, query, &blocks_[0], static_cast<uint32_t>(blocks_.block_bytes())};
    }
    void decide(PacketQuery& packet, uint32_t lanes, float* farthest) const;
};

}  // namespace rayleaf
