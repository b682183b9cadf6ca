#include "trace/strand_scene.h"

#include <algorithm>
#include <limits>

namespace rayleaf {
namespace {

/// Pieces have boxes along the axes: halving one is worth it while that leaves less than this share of their surface...
constexpr double kWorthHalving = 0.75;
/// ...so often at most: memory doubles each time.
constexpr uint16_t kMostHalvings = 3;

/// Radius of a point query, local units: its position is a float.
constexpr float kPointRadius = 0x1p-18f;

double surface_area(const Box3d& box) {
    const Vec3d size = box.max - box.min;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

enum class Crossing : uint8_t { Enters, Leaves };

/// A strand that the start of a ray lies in, and where the ray leaves it.
struct StrandExit {
    uint32_t strand = 0;
    StrandLeave place;
};

}  // namespace

/// One ray, as Embree's callbacks find it: the context is the first member.
struct StrandScene::Query {
    EmbreeContext context;
    const StrandScene* scene = nullptr;
    const LocalRay* ray = nullptr;
    StrandRay frame;
    Vec3f float_origin{0, 0, 0}, float_x{1, 0, 0}, float_y{0, 1, 0};  ///< of the frame
    ShapeHit best;
    double begin = 0;     ///< the true start in the frame, and a little beyond: the rounding of t
    double farthest = 0;  ///< t of the best hit, or the ray's t_max
    Crossing best_crossing = Crossing::Enters;
    bool found = false;
    bool any = false;               ///< whether one hit is enough
    std::vector<StrandExit> exits;  ///< of the strands that the ray starts in

    // What `find_holding` looks for and finds.
    uint32_t wanted_strand = 0;
    double wanted_distance = 0;
    bool holds = false;
    StrandLeave last;

    Query(const StrandScene& strand_scene, const LocalRay& local)
        : scene(&strand_scene),
          ray(&local),
          frame(local.origin + local.direction * local.start, local.direction / local.speed),
          float_origin(frame.origin),
          float_x(frame.across_x),
          float_y(frame.across_y),
          begin((local.t_min - local.start) * local.speed + kBackstep),
          farthest(local.t_max) {
        initialize(context);
    }
    static Query& of(EmbreeContext* embree_context) { return *reinterpret_cast<Query*>(embree_context); }

    double t_of(double along) const { return ray->start + along / ray->speed; }

    /// Takes a hit if it is the nearest so far.
    void offer(const FacetId& facet, double s, double along, Crossing crossing) {
        const double t = t_of(along);
        if (!(t >= ray->t_min && t <= farthest)) return;
        if (found && t == farthest && best.facet < facet) return;
        best.facet = facet;
        best.point.t = t;
        best.point.u = s;
        best.point.position = frame.origin + frame.along * along;
        farthest = t;
        found = true;
        best_crossing = crossing;
    }
    /// Takes back all hits, but those that leave.
    void restart() {
        found = false;
        farthest = ray->t_max;
        for (const StrandExit& exit : exits) offer(exit.place, Crossing::Leaves);
    }
    void offer(const StrandLeave& place, Crossing crossing) { offer(place.facet, place.s, place.distance, crossing); }
    /// Whether the ray starts in a strand and a place lies before it has left it.
    bool starts_before_exit(uint32_t strand, double t) const {
        const StrandExit* exit = exit_of(strand);
        return exit != nullptr && t <= t_of(exit->place.distance);
    }
    const StrandExit* exit_of(uint32_t strand) const {
        const auto at =
            std::find_if(exits.begin(), exits.end(), [strand](const StrandExit& e) { return e.strand == strand; });
        return at == exits.end() ? nullptr : &*at;
    }
};

StrandScene::StrandScene(const Strands& strands, const CancelToken& cancel)
    : ShapeScene(strands, FacetKind::Strands), strands_(&strands) {
    add_pieces(cancel);
    if (pieces_.empty()) return;
    EmbreeScene scene = new_embree_scene(cancel);
    build_embree_scene(scene,
                       new_user_geometry(this, pieces_.size(), {bounds_callback, closest_callback, any_callback}));
    set_scene(std::move(scene), strands.bounds());
}

void StrandScene::add_pieces(const CancelToken& cancel) {
    constexpr uint32_t kCancelStride = 1u << 14;
    const bool spheres = strands_->form() == StrandForm::Spheres;
    for (uint32_t segment = 0; segment < strands_->element_count(); ++segment) {
        if (segment % kCancelStride == 0) cancel.throw_if_cancelled();
        const StrandSegment curve = strands_->segment(segment);
        const std::array<StrandPoint, 4>& p = curve.points;
        if (std::max(std::max(p[0].w, p[1].w), std::max(p[2].w, p[3].w)) == 0.0) continue;  // nothing to hit
        const uint16_t level = spheres ? 0 : split_level(curve);
        const auto count = static_cast<uint16_t>(spheres ? strands_->spheres_per_segment() + 1 : 1 << level);
        for (uint16_t index = 0; index < count; ++index) {
            Piece& piece = pieces_.emplace_back();
            piece.segment = segment;
            piece.index = index;
            piece.level = level;
            set_capsule(piece);
        }
    }
    pieces_.shrink_to_fit();
}

void StrandScene::set_capsule(Piece& piece) const {
    StrandSegment curve;
    if (strands_->form() == StrandForm::Spheres)
        curve.points.fill(ball(piece));
    else
        curve = strands_->segment(piece.segment).part(piece.level, piece.index);
    const std::array<StrandPoint, 4>& p = curve.points;
    // |C - chord| <= max|C''| / 8, and |C''| <= 6 max|second difference|.
    const double bend =
        std::max(axis_point(p[0] - p[1] * 2.0 + p[2]).length(), axis_point(p[1] - p[2] * 2.0 + p[3]).length());
    const double radius = std::max(std::max(p[0].w, p[1].w), std::max(p[2].w, p[3].w));
    piece.begin = Vec3f(axis_point(p[0]));
    piece.end = Vec3f(axis_point(p[3]));
    piece.radius = static_cast<float>(radius + 0.75 * bend + kBoxPadding);
}

uint16_t StrandScene::split_level(const StrandSegment& segment) const {
    double area = surface_area(segment.bounds());
    uint16_t level = 0;
    for (; level < kMostHalvings; ++level) {
        double halved = 0.0;
        for (uint32_t i = 0; i < 2u << level; ++i) halved += surface_area(segment.part(level + 1u, i).bounds());
        if (!(halved < kWorthHalving * area)) break;
        area = halved;
    }
    return level;
}

StrandPoint StrandScene::ball(const Piece& piece) const {
    return strands_->segment(piece.segment).at(static_cast<double>(piece.index) / strands_->spheres_per_segment());
}

Box3d StrandScene::box_of(const Piece& piece) const {
    if (strands_->form() != StrandForm::Spheres)
        return strands_->segment(piece.segment).part(piece.level, piece.index).bounds();
    const StrandPoint center = ball(piece);
    return {axis_point(center) - Vec3d(center.w), axis_point(center) + Vec3d(center.w)};
}

void StrandScene::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const StrandScene*>(arguments->geometryUserPtr);
    const Box3d box = self.box_of(self.pieces_[arguments->primID]);
    const Vec3f padding(static_cast<float>(kBoxPadding));
    const Vec3f low = Vec3f(box.min) - padding, high = Vec3f(box.max) + padding;
    *arguments->bounds_o = {low.x, low.y, low.z, 0.0f, high.x, high.y, high.z, 0.0f};
}

StrandSpans StrandScene::spans(const Query& query, const Piece& piece, double needs_leave_before) const {
    if (strands_->form() == StrandForm::Spheres) {
        const StrandSegment in_frame = query.frame.to_frame(strands_->segment(piece.segment));
        StrandSpans result;
        if (const auto span =
                ball_span(in_frame.at(static_cast<double>(piece.index) / strands_->spheres_per_segment())))
            result.add(*span);
        return result;
    }
    return round_spans(query.frame.to_frame(strands_->segment(piece.segment)).part(piece.level, piece.index),
                       needs_leave_before);
}

/// Whether single precision is sure that the ray passes the piece.
bool StrandScene::passes(const Query& query, const Piece& piece) {
    const Vec3f begin = piece.begin - query.float_origin, end = piece.end - query.float_origin;
    const float x = begin.dot(query.float_x), y = begin.dot(query.float_y);
    const float dx = end.dot(query.float_x) - x, dy = end.dot(query.float_y) - y;
    const float length2 = dx * dx + dy * dy, along = -(x * dx + y * dy);
    const float s = along <= 0.0f ? 0.0f : along >= length2 ? 1.0f : along / length2;
    const float nearest_x = x + dx * s, nearest_y = y + dy * s;
    return nearest_x * nearest_x + nearest_y * nearest_y > piece.radius * piece.radius;
}

void StrandScene::visit(Query& query, uint32_t index) const {
    const Piece& piece = pieces_[index];
    if (passes(query, piece)) return;
    if (strands_->form() == StrandForm::Ribbon) {
        visit_ribbon(query, piece);
        return;
    }
    const StrandSpans found = spans(query, piece, query.begin);
    for (int i = 0; i < found.count; ++i) {
        const StrandSpan& span = found.spans[i];
        if (query.t_of(span.enter) >= query.ray->t_min)
            enter(query, piece, span);
        else if (query.t_of(span.leave) >= query.ray->t_min)
            follow_out(query, strands_->strand_of(piece.segment),
                       {{piece.segment, piece.index}, place_of(piece, span.s_leave), span.leave});
    }
}

/// The parameter along the segment of one along a piece.
double StrandScene::place_of(const Piece& piece, double s) const {
    if (strands_->form() == StrandForm::Spheres)
        return static_cast<double>(piece.index) / strands_->spheres_per_segment();
    return (piece.index + s) / static_cast<double>(1u << piece.level);
}

void StrandScene::enter(Query& query, const Piece& piece, const StrandSpan& span) const {
    const uint32_t strand = strands_->strand_of(piece.segment);
    const double t = query.t_of(span.enter);
    if (t > query.farthest || query.starts_before_exit(strand, t)) return;
    // Whoever wants any hit stops at this one, so it must be known now whether it lies inside the strand.
    if (query.any && starts_inside(query, strand) && query.starts_before_exit(strand, t)) return;
    query.offer({piece.segment, piece.index}, place_of(piece, span.s_enter), span.enter, Crossing::Enters);
}

/// The ray starts in this strand: follows it through all pieces that hold it to where it leaves.
void StrandScene::follow_out(Query& query, uint32_t strand, StrandLeave place) const {
    if (query.exit_of(strand) != nullptr) return;
    while (find_holding(query, strand, place.distance)) place = query.last;
    query.exits.push_back({strand, place});
    query.offer(place, Crossing::Leaves);
}

/// Whether the ray starts inside the strand; if so, its exit is known then.
bool StrandScene::starts_inside(Query& query, uint32_t strand) const {
    if (query.exit_of(strand) != nullptr) return true;
    if (query.ray->start >= query.ray->t_min) return false;  // it starts outside the whole shape
    const double begin = (query.ray->t_min - query.ray->start) * query.ray->speed;
    if (!find_holding(query, strand, begin)) return false;
    follow_out(query, strand, query.last);
    return true;
}

/// Whether pieces of a strand hold the place at a distance along the ray; `last` is then the one that is left last.
bool StrandScene::find_holding(Query& query, uint32_t strand, double distance) const {
    query.wanted_strand = strand;
    query.wanted_distance = distance;
    query.holds = false;
    const Vec3f position(query.frame.origin + query.frame.along * distance);
    RTCPointQuery point{position.x, position.y, position.z, 0.0f, kPointRadius};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(embree_scene(), &point, &context, holding_callback, &query);
    return query.holds;
}

bool StrandScene::holding_callback(RTCPointQueryFunctionArguments* arguments) {
    Query& query = *static_cast<Query*>(arguments->userPtr);
    const StrandScene& self = *query.scene;
    const Piece& piece = self.pieces_[arguments->primID];
    if (self.strands_->strand_of(piece.segment) != query.wanted_strand || passes(query, piece)) return false;
    const FacetId facet{piece.segment, piece.index};
    const StrandSpans found = self.spans(query, piece, std::numeric_limits<double>::infinity());
    for (int i = 0; i < found.count; ++i) {
        const StrandSpan& span = found.spans[i];
        if (!(span.enter <= query.wanted_distance && query.wanted_distance < span.leave)) continue;
        const bool further = !query.holds || span.leave > query.last.distance ||
                             (span.leave == query.last.distance && facet < query.last.facet);
        if (further) query.last = {facet, self.place_of(piece, span.s_leave), span.leave};
        query.holds = true;
    }
    return false;  // the radius of the point query is as before
}

/// Whether the axis, past an end of a piece, comes no nearer to the ray: it ends there, cut straight, or runs on.
bool StrandScene::is_nearest_at_end(const Query& query, const Piece& piece, const StrandSegment& in_frame,
                                    int end) const {
    uint32_t segment = piece.segment;
    int64_t index = int64_t{piece.index} + end;
    uint16_t level = piece.level;
    if (index < 0 || index >= int64_t{1} << level) {
        const std::optional<uint32_t> next = strands_->neighbour(segment, end);
        if (!next) return false;
        segment = *next;
        level = 0;
        index = 0;
    }
    const StrandSegment other =
        query.frame.to_frame(strands_->segment(segment)).part(level, static_cast<uint32_t>(index));
    const StrandPoint direction = other.derivative(end > 0 ? 0.0 : 1.0);
    return recedes(in_frame.points[end > 0 ? 3 : 0], direction, end);
}

void StrandScene::visit_ribbon(Query& query, const Piece& piece) const {
    const StrandSegment curve = query.frame.to_frame(strands_->segment(piece.segment)).part(piece.level, piece.index);
    const RibbonHits found = ribbon_hits(curve);
    for (int i = 0; i < found.count; ++i) {
        const RibbonHit& hit = found.hits[i];
        if (hit.end != 0 && !is_nearest_at_end(query, piece, curve, hit.end)) continue;
        query.offer({piece.segment, piece.index}, place_of(piece, hit.s), hit.distance, Crossing::Enters);
    }
}

void StrandScene::closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    Query& query = Query::of(arguments->context);
    query.scene->visit(query, arguments->primID);
    float& t_max = RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
    if (query.found) t_max = query.ray->float_distance(query.farthest);
}

void StrandScene::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    Query& query = Query::of(arguments->context);
    query.scene->visit(query, arguments->primID);
    if (query.found) RTCRayN_tfar(arguments->ray, arguments->N, 0) = -std::numeric_limits<float>::infinity();
}

bool StrandScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    Query query(*this, ray);
    for (;;) {
        RTCRayHit embree_ray = ray.embree_ray_hit();
        embree_closest(embree_scene(), query.context, embree_ray);
        if (!query.found) return false;
        const bool inside = query.best_crossing == Crossing::Enters &&
                            query.starts_before_exit(strands_->strand_of(query.best.facet.primitive), query.farthest);
        if (!inside) break;
        query.restart();  // what was taken for an entry lies inside a strand that the ray was found to start in
    }
    set_normal(query);
    hit = query.best;
    return true;
}

bool StrandScene::occluded(const LocalRay& ray) const {
    Query query(*this, ray);
    query.any = true;
    RTCRay embree_ray = ray.embree_ray();
    embree_any(embree_scene(), query.context, embree_ray);
    return query.found;
}

void StrandScene::set_normal(Query& query) const {
    const FacetId& facet = query.best.facet;
    const double s = query.best.point.u;
    const StrandSegment curve = strands_->segment(facet.primitive);
    const Vec3d radius = query.best.point.position - axis_point(curve.at(s));
    const Vec3d towards = -query.frame.along;
    if (strands_->form() != StrandForm::Ribbon) {
        query.best.normal = normalized_or(radius, towards);
        return;
    }
    const Vec3d tangent = normalized_or(axis_point(curve.derivative(s)), Vec3d(0.0));
    query.best.normal = normalized_or(towards - tangent * tangent.dot(towards), towards);
}

LocalHit StrandScene::local_hit(const ShapeHit& hit) const {
    LocalHit local;
    const StrandSegment curve = strands_->segment(hit.facet.primitive);
    const double s = std::clamp(hit.point.u, 0.0, 1.0);
    local.primitive = hit.facet.primitive;
    local.u = static_cast<float>(s);
    local.position = hit.point.position;
    local.normal = Vec3f(hit.normal);
    const Vec3d tangent = normalized_or(axis_point(curve.derivative(s)), Vec3d(0, 0, 1));
    Vec3d around = hit.normal;
    if (strands_->form() == StrandForm::Ribbon) {
        // Shaded as the wall of the round strand at the same place across.
        const Vec3d across = hit.point.position - axis_point(curve.at(s));
        const double sine = std::min(across.length() / curve.at(s).w, 1.0);
        around = normalized_or(across, Vec3d(0.0)) * sine + hit.normal * std::sqrt(1.0 - sine * sine);
    }
    local.v = s > 0.0 && s < 1.0 ? wall_angle(tangent, around) : kStrandEnd;
    return local;
}

}  // namespace rayleaf
