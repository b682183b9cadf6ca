// Strands: a tree over leaves of up to eight pieces of segments finds those a ray may meet, double precision decides.
//
// Several pieces of a strand may hold the place where a ray enters or leaves another: inside the strand there is no
// surface. So an entry counts only if the ray does not start inside the strand, and a leave is followed through all
// pieces that hold it (trace/strand_inside.cpp). Of hair, which has no inside, a ray knows the segment that it starts
// on and does not meet it, as in Cycles; so nothing need be found out about its start.
#pragma once

#include "base/maybe.h"
#include "geometry/strands.h"
#include "trace/capsules.h"
#include "trace/moving_tree.h"
#include "trace/shape_scene.h"
#include "trace/strand_intersection.h"

#include <optional>
#include <vector>

namespace rayleaf {

/// The place where a ray leaves a piece.
struct StrandLeave {
    FacetId facet;        ///< segment and piece
    double s = 0;         ///< along the segment
    double distance = 0;  ///< along the ray, in its frame
};

class StrandScene final : public ShapeScene {
  public:
    StrandScene(const Strands& strands, const CancelToken& cancel);

    bool closest(const LocalRay& ray, ShapeHit& hit) const override;
    bool occluded(const LocalRay& ray) const override;
    void find_closest(PacketQuery& packet) const override;
    void find_any(PacketQuery& packet) const override;
    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override { return hit; }
    double float_error() const override { return kStrandError; }
    uint64_t strand_pieces() const override { return piece_count_; }
    uint64_t tree_bytes() const override { return tree_.bytes() + capsules_.bytes(); }
    uint64_t record_bytes() const override { return pieces_.bytes(); }

  private:
    /// How far a hit may lie from the strand's exact surface, local units: coordinates of the order of 1 in double, and
    /// the extremum's error.
    static constexpr double kStrandError = 0x1p-40;

    /// Part number `index` of 2^level of a segment; of the form Spheres, ball number `index`.
    struct Piece {
        uint32_t segment = 0;
        uint16_t index = 0, level = 0;
        Strands::Place place{};
    };
    struct Query;
    struct Packet;
    enum class Wanted : uint8_t { Closest, Any };

    const Strands* strands_;
    /// Where they are is known before the leaf's capsules have been read.
    struct alignas(64) LeafPieces {
        Piece of[Capsules::kMost];
    };
    uint64_t piece_count_ = 0;
    LargeArray<LeafPieces> pieces_;  ///< by leaf
    LargeArray<Capsules> capsules_;  ///< leaf by leaf, each at all steps
    MeetCapsules meet_capsules_;
    MovingTree tree_;  ///< of capsules_

    /// Segment by segment. Items of the tree are runs of a segment's pieces.
    struct Pieces {
        LargeArray<Piece> all;
        LargeArray<uint32_t> items;  ///< the first piece of each, and at the end the number of pieces
    };
    Pieces all_pieces(const CancelToken& cancel) const;
    uint16_t split_level(const StrandSegment& segment) const;
    StrandPoint ball(const Piece& piece, float time) const;
    Box3f float_box(const Piece& piece, float time) const;
    Box3d box_at(const Piece& piece, float time) const;
    /// Whether a segment is thicker than nothing at some time.
    bool can_be_hit(uint32_t segment) const;
    /// A leaf's at a time, mixed in `room` where they move.
    const Capsules& capsules(uint32_t leaf, float time, Maybe<Capsules>& room) const {
        return deforms() ? mixed_capsules(leaf, time, room) : capsules_[leaf];
    }
    const Capsules& mixed_capsules(uint32_t leaf, float time, Maybe<Capsules>& room) const;
    void build_tree(const Pieces& pieces, const CancelToken& cancel);
    void set_capsule(Capsules& capsules, uint32_t lane, const Piece& piece, float time) const;
    StrandSpans spans(const Query& query, const Piece& piece, double needs_leave_before) const;
    StrandSegment segment_of(const Piece& piece, float time) const {
        return strands_->segment(piece.segment, piece.place, time);
    }
    double place_of(const Piece& piece, double s) const;
    void find(const LocalRay& ray, Query& query) const;
    void find(PacketQuery& packet, Wanted wanted) const;
    BoxVisitor visitor(BoxVisitor::Visit at_leaf, void* owner) const;
    void visit_leaf(Query& query, uint32_t leaf, float& farthest) const;
    void visit(Query& query, const Piece& piece) const;
    void enter(Query& query, const Piece& piece, const StrandSpan& span) const;
    /// Whether rays know the segment that they start on (RayAnchor::facet).
    bool is_hair() const { return !strands_->has_inside() && strands_->form() != StrandForm::Spheres; }
    /// In the ray's frame, the piece before (end -1) or after (1) one of the same segment, or all of the segment there;
    /// empty at an end of the strand.
    std::optional<StrandSegment> beside(const Query& query, const Piece& piece, int end) const;
    bool neighbours_hold(const Query& query, const Piece& piece, double distance) const;
    void follow_out(Query& query, uint32_t strand, StrandLeave place) const;
    bool starts_inside(Query& query, uint32_t strand) const;
    bool find_holding(Query& query, uint32_t strand, double distance) const;
    void visit_holding(Query& query, uint32_t leaf) const;
    void hold(Query& query, const Piece& piece) const;
    bool is_inside(const Query& query) const;
    void visit_ribbon(Query& query, const Piece& piece) const;
    bool is_nearest_at_end(const Query& query, const Piece& piece, const StrandSegment& in_frame, int end) const;
    void set_normal(Query& query) const;
};

}  // namespace rayleaf
