// Strands as Embree's user geometry: its boxes find the pieces of segments a ray may meet, double precision decides.
//
// Several pieces of a strand may hold the place where a ray enters or leaves another: inside the strand there is no
// surface. So an entry counts only if the ray does not start inside the strand, and a leave is followed through all
// pieces that hold it (`inside`).
#pragma once

#include "geometry/strands.h"
#include "trace/shape_scene.h"
#include "trace/strand_intersection.h"

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
    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override { return hit; }
    double float_error() const override { return kStrandError; }
    uint64_t strand_pieces() const override { return pieces_.size(); }

  private:
    /// How far a hit may lie from the strand's exact surface, local units: coordinates of the order of 1 in double, and
    /// the extremum's error.
    static constexpr double kStrandError = 0x1p-40;

    /// Part number `index` of 2^level of a segment; of the form Spheres, ball number `index`. It lies within `radius`
    /// of the line from `begin` to `end`, as single precision computes with these (local space).
    struct Piece {
        Vec3f begin{0, 0, 0}, end{0, 0, 0};
        float radius = 0;
        uint32_t segment = 0;
        uint16_t index = 0, level = 0;
    };
    struct Query;

    const Strands* strands_;
    std::vector<Piece> pieces_;

    void add_pieces(const CancelToken& cancel);
    uint16_t split_level(const StrandSegment& segment) const;
    StrandPoint ball(const Piece& piece) const;
    Box3d box_of(const Piece& piece) const;
    void set_capsule(Piece& piece) const;
    StrandSpans spans(const Query& query, const Piece& piece, double needs_leave_before) const;
    double place_of(const Piece& piece, double s) const;
    static bool passes(const Query& query, const Piece& piece);
    void visit(Query& query, uint32_t index) const;
    void enter(Query& query, const Piece& piece, const StrandSpan& span) const;
    void follow_out(Query& query, uint32_t strand, StrandLeave place) const;
    bool starts_inside(Query& query, uint32_t strand) const;
    bool find_holding(Query& query, uint32_t strand, double distance) const;
    void visit_ribbon(Query& query, const Piece& piece) const;
    bool is_nearest_at_end(const Query& query, const Piece& piece, const StrandSegment& in_frame, int end) const;
    void set_normal(Query& query) const;

    static void bounds_callback(const RTCBoundsFunctionArguments* arguments);
    static void closest_callback(const RTCIntersectFunctionNArguments* arguments);
    static void any_callback(const RTCOccludedFunctionNArguments* arguments);
    static bool holding_callback(RTCPointQueryFunctionArguments* arguments);
};

}  // namespace rayleaf
