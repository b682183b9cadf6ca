// The surface points of many hits, over lanes: the local surface of spline patches too, that of other shapes one by
// one.
#include "geometry/patch_surface.h"
#include "trace/surface_lanes.h"
#include "trace/tracer_queries.h"

#include <array>
#include <memory>
#include <optional>

namespace rayleaf {
namespace {

/// Hits that one kernel does together, and what it does not need to know of them.
struct LaneGroup {
    SurfaceLanes lanes;
    std::array<const SurfaceQuery*, SurfaceLanes::kMost> queries;
    std::array<Vec2f, SurfaceLanes::kMost> uv;
    using Records = std::array<std::optional<InstanceRecord>, SurfaceLanes::kMost>;
    std::unique_ptr<Records> moved;  ///< of instances that move; made where there are any

    bool is_full() const { return lanes.count == SurfaceLanes::kMost; }
};

/// Patches at the hits' times, of surfaces that deform.
using MixedPatches = std::array<std::array<Vec4d, SurfaceLanes::kMostPoints>, SurfaceLanes::kMost>;

/// Fewer patches of a form are done one by one.
constexpr size_t kLeastPatches = 3;

const PatchSurface* patches_of(const InstanceRecord& record) {
    const Shape& shape = record.scene->shape();
    return shape.kind() == ShapeKind::PatchSurface ? static_cast<const PatchSurface*>(&shape) : nullptr;
}

template <typename Row, typename T>
void put(const Imath::Vec3<T>& v, Row (&rows)[3], size_t i) {
    rows[0][i] = v.x;
    rows[1][i] = v.y;
    rows[2][i] = v.z;
}
template <typename T>
Imath::Vec3<T> row(const T (&rows)[3][SurfaceLanes::kMost], size_t i) {
    return {rows[0][i], rows[1][i], rows[2][i]};
}

/// What is needed of every hit; the lane that it gets.
size_t add_hit(LaneGroup& group, const SurfaceQuery& query, const InstanceRecord& record) {
    SurfaceLanes& lanes = group.lanes;
    const size_t i = lanes.count++;
    const LocalHit& hit = query.hit->local;
    group.queries[i] = &query;
    lanes.records[i] = &record;
    if (record.motion) {
        if (!group.moved) group.moved = std::make_unique<LaneGroup::Records>();
        lanes.records[i] = record.at(query.ray->time, (*group.moved)[i]);
    }
    lanes.size[i] = max_abs(query.ray->origin) + query.hit->t * max_abs(query.ray->direction);
    lanes.float_error[i] = record.scene->float_error();
    lanes.vertex_error[i] = record.scene->vertex_error();
    put(hit.position, lanes.facet_position, i);
    put(hit.normal, lanes.facet_normal, i);
    return i;
}

void add_surface(LaneGroup& group, const SurfaceQuery& query, const InstanceRecord& record, SurfaceDetail detail) {
    SurfaceLanes& lanes = group.lanes;
    const size_t i = add_hit(group, query, record);
    const LocalSurface local = record.local_surface(query.hit->local, detail);
    group.uv[i] = local.uv;
    put(local.position, lanes.position, i);
    put(local.normal, lanes.normal, i);
    put(local.dp_du, lanes.dp_du, i);
    put(local.dp_dv, lanes.dp_dv, i);
    put(local.dn_du, lanes.dn_du, i);
    put(local.dn_dv, lanes.dn_dv, i);
}

void add_patch(LaneGroup& group, const SurfaceQuery& query, const InstanceRecord& record, const PatchSurface& surface,
               const SplinePatches& spline, MixedPatches& mixed) {
    SurfaceLanes& lanes = group.lanes;
    const size_t i = add_hit(group, query, record);
    const LocalHit& hit = query.hit->local;
    const SplineSpan &u = spline.span_u(hit.primitive), &v = spline.span_v(hit.primitive);
    group.uv[i] = Vec2f(static_cast<float>(u.begin + hit.u * (u.end - u.begin)),
                        static_cast<float>(v.begin + hit.v * (v.end - v.begin)));
    lanes.points[i] = surface.patch(hit.primitive, spline).points;
    if (surface.deforms()) {
        surface.mix_points(hit.primitive, spline, hit.time, mixed[i].data());
        lanes.points[i] = mixed[i].data();
    }
    lanes.u[i] = hit.u;
    lanes.v[i] = hit.v;
    lanes.length_u[i] = u.end - u.begin;
    lanes.length_v[i] = v.end - v.begin;
}

/// Repeats the last hit in the lanes beyond it.
void fill_up(SurfaceLanes& lanes, bool are_patches) {
    const size_t last = lanes.count - 1;
    const auto fill = [&](auto&... rows) {
        for (size_t i = lanes.count; i < SurfaceLanes::kMost; ++i) ((rows[i] = rows[last]), ...);
    };
    const auto fill_vectors = [&](auto&... rows) { (fill(rows[0], rows[1], rows[2]), ...); };
    fill(lanes.records, lanes.size, lanes.float_error, lanes.vertex_error);
    fill_vectors(lanes.facet_position, lanes.facet_normal);
    if (are_patches)
        fill(lanes.points, lanes.u, lanes.v, lanes.length_u, lanes.length_v);
    else
        fill_vectors(lanes.position, lanes.normal, lanes.dp_du, lanes.dp_dv, lanes.dn_du, lanes.dn_dv);
}

/// Every field but the sight is set in its place: to clear the whole point before costs as much.
void take(const LaneGroup& group, size_t i, SurfaceDetail detail) {
    const SurfaceLanes& lanes = group.lanes;
    const SurfaceQuery& query = *group.queries[i];
    const Hit& hit = *query.hit;
    SurfacePoint& point = *query.point;
    point.position = row(lanes.position, i);
    point.facet_position = row(lanes.facet_position, i);
    point.start_offset = lanes.start_offset[i];
    point.facet_error = lanes.facet_error[i];
    point.facet_normal = row(lanes.facet_normal, i);
    point.normal = row(lanes.normal, i);
    point.dp_du = row(lanes.dp_du, i);
    point.dp_dv = row(lanes.dp_dv, i);
    point.dn_du = detail == SurfaceDetail::Curvature ? row(lanes.dn_du, i) : Vec3f(0.0f);
    point.dn_dv = detail == SurfaceDetail::Curvature ? row(lanes.dn_dv, i) : Vec3f(0.0f);
    point.uv = group.uv[i];
    point.uv_by_u = Vec2f(1, 0);
    point.uv_by_v = Vec2f(0, 1);
    point.t = hit.t;
    point.time = query.ray->time;
    point.shape = &lanes.records[i]->scene->shape();
    point.local = hit.local;
    point.instance = hit.instance;
    point.inside = point.interpolated = false;
}

/// Hits of one call, those on patches of one form together.
class SurfaceBatch {
  public:
    static constexpr size_t kMost = 32;

    SurfaceBatch(const Tracer& tracer, SurfaceDetail detail) : tracer_(tracer), detail_(detail) {}

    void add(const SurfaceQuery& query, const InstanceRecord& record) {
        if (query.hit->is_interpolated()) return add_alone(query);
        const PatchSurface* surface = patches_of(record);
        const SplinePatches* spline = surface ? &surface->spline_of(query.hit->local.primitive) : nullptr;
        if (!spline || !spline->smooth || !has_lanes(form_of(*spline))) {
            add_surface(others_, query, record, detail_);
            if (others_.is_full()) place(others_);
            return;
        }
        open_ |= 1u << count_;
        waiting_[count_++] = {&query, &record, surface, spline};
        if (count_ == kMost) finish_patches();
    }
    void finish() {
        finish_patches();
        place(others_);
    }

  private:
    struct Waiting {
        const SurfaceQuery* query;
        const InstanceRecord* record;
        const PatchSurface* surface;
        const SplinePatches* spline;
    };
    const Tracer& tracer_;
    SurfaceDetail detail_;
    std::array<Waiting, kMost> waiting_;
    size_t count_ = 0;
    uint32_t open_ = 0;  ///< of those that wait, a bit each
    LaneGroup patches_, others_;
    MixedPatches mixed_;

    static PatchForm form_of(const SplinePatches& spline) {
        return {spline.degree_u, spline.degree_v, spline.rational};
    }

    void add_alone(const SurfaceQuery& query) { *query.point = tracer_.surface_point(*query.ray, *query.hit, detail_); }

    void finish_patches() {
        while (open_ != 0) {
            const PatchForm form = form_of(*waiting_[static_cast<size_t>(__builtin_ctz(open_))].spline);
            for_each_lane(open_, [&](size_t i) {
                const Waiting& hit = waiting_[i];
                if (!(form_of(*hit.spline) == form)) return;
                open_ &= ~(1u << i);
                add_patch(patches_, *hit.query, *hit.record, *hit.surface, *hit.spline, mixed_);
                if (patches_.is_full()) place(patches_, &form);
            });
            place(patches_, &form);
        }
        count_ = 0;
    }

    /// `form`: of patches, whose local surface is not known yet.
    void place(LaneGroup& group, const PatchForm* form = nullptr) {
        SurfaceLanes& lanes = group.lanes;
        lanes.done = 0;
        if (lanes.count >= (form ? kLeastPatches : 1)) {
            lanes.done = (1u << lanes.count) - 1;
            if (!group.is_full()) fill_up(lanes, form != nullptr);
            if (form) compute_patches(*form, detail_, lanes);
            place_surfaces(detail_, lanes);
        }
        for (size_t i = 0; i < lanes.count; ++i) {
            if ((lanes.done >> i & 1u) != 0)
                take(group, i, detail_);
            else
                add_alone(*group.queries[i]);
        }
        lanes.count = 0;
    }
};

}  // namespace

void Tracer::surface_points(std::span<const SurfaceQuery> queries, SurfaceDetail detail) const {
    SurfaceBatch batch(*this, detail);
    for (const SurfaceQuery& query : queries) batch.add(query, implementation_->records[query.hit->instance]);
    batch.finish();
    for (const SurfaceQuery& query : queries)
        query.point->sight =
            query.hit->local.subpatch_length > 0.0f ? implementation_->sight_from(*query.ray, *query.hit) : RaySight();
}

}  // namespace rayleaf
