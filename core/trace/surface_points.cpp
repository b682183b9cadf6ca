// The surface points of many hits, over lanes. The local surface is found over lanes too on spline patches and on most
// walls of bevelled curves, one by one on the others.
#include "base/short_list.h"
#include "geometry/patch_surface.h"
#include "trace/surface_lanes.h"
#include "trace/tracer_queries.h"
#include "trace/wall_lanes.h"

#include <array>
#include <memory>

namespace rayleaf {
namespace {

/// Hits that one kernel does together, and what it does not need to know of them.
struct LaneGroup {
    SurfaceLanes lanes;
    std::array<const SurfaceQuery*, SurfaceLanes::kMost> queries;
    std::array<Vec2f, SurfaceLanes::kMost> uv;
    using Records = std::array<Maybe<InstanceRecord>, SurfaceLanes::kMost>;
    std::unique_ptr<Records> moved;  ///< of instances that move; made where there are any

    bool is_full() const { return lanes.count == SurfaceLanes::kMost; }
};

/// Patches at the hits' times, of surfaces that deform.
using MixedPatches = std::array<std::array<Vec4d, SurfaceLanes::kMostPoints>, SurfaceLanes::kMost>;

/// A shape of the type that its kind says; else null.
template <typename T>
const T* shape_as(const InstanceRecord& record, ShapeKind kind) {
    const Shape& shape = record.scene->shape();
    return shape.kind() == kind ? static_cast<const T*>(&shape) : nullptr;
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
    const PatchView patch = surface.patch(hit.primitive, spline);
    lanes.points[i] = patch.points;
    lanes.strides[i] = static_cast<int64_t>(patch.stride);
    if (surface.deforms()) {
        surface.mix_points(hit.primitive, spline, hit.time, mixed[i].data());
        lanes.points[i] = mixed[i].data();
        lanes.strides[i] = patch.columns();
    }
    lanes.u[i] = hit.u;
    lanes.v[i] = hit.v;
    lanes.length_u[i] = u.end - u.begin;
    lanes.length_v[i] = v.end - v.begin;
}

void add_wall(LaneGroup& group, WallLanes& walls, const SurfaceQuery& query, const InstanceRecord& record,
              const SweepPath& path, const WallPlace& wall) {
    const size_t i = add_hit(group, query, record);
    const CurvedPlace at = path.place(*wall.piece, wall.u);
    group.uv[i] = wall.uv;
    walls.controls[i] = at.controls;
    walls.t[i] = at.t;
    walls.length[i] = at.length;
    walls.size[i] = at.segment->size;
    walls.scale[i] = path.scale;
    put(at.tangent, walls.tangent, i);
    put(at.normal, walls.normal, i);
    walls.turn[i] = at.turn;
    walls.turn_change[i] = at.turn_change;
    walls.factor[i] = at.radius.factor;
    walls.factor_change[i] = at.radius.factor_change;
    walls.added[i] = at.radius.added;
    walls.added_change[i] = at.radius.added_change;
    for (int axis = 0; axis < 2; ++axis) {
        walls.place[axis][i] = wall.around.position[axis];
        walls.direction[axis][i] = wall.around.first[axis];
    }
    walls.length_u[i] = wall.length_u;
    walls.length_v[i] = wall.length_v;
}

/// Repeats the last of `count` hits in the lanes beyond it.
template <typename... Rows>
void fill_up(size_t count, Rows&... rows) {
    for (size_t i = count; i < SurfaceLanes::kMost; ++i) ((rows[i] = rows[count - 1]), ...);
}
template <typename... Rows>
void fill_up_vectors(size_t count, Rows&... rows) {
    for (size_t axis = 0; axis < 3; ++axis) fill_up(count, rows[axis]...);
}
void fill_up(size_t count, WallLanes& w) {
    fill_up(count, w.controls, w.t, w.length, w.size, w.scale, w.turn, w.turn_change, w.factor, w.factor_change,
            w.added, w.added_change, w.place[0], w.place[1], w.direction[0], w.direction[1], w.length_u, w.length_v);
    fill_up_vectors(count, w.tangent, w.normal);
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

/// Hits of one call: those on patches of one form together, those on walls, and the others.
class SurfaceBatch {
  public:
    static constexpr size_t kMost = 32;

    SurfaceBatch(const Tracer& tracer, SurfaceDetail detail) : tracer_(tracer), detail_(detail) {}

    void add(const SurfaceQuery& query, const InstanceRecord& record) {
        if (query.hit->is_interpolated()) return add_alone(query);
        if (wait_for_patches(query, record) || try_wall(query, record)) return;
        add_surface(others_, query, record, detail_);
        if (others_.is_full()) place_others();
    }
    void finish() {
        finish_patches();
        place_walls();
        place_others();
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
    LaneGroup patches_, walls_, others_;
    MixedPatches mixed_;
    WallLanes wall_lanes_;

    static PatchForm form_of(const SplinePatches& spline) {
        return {spline.degree_u, spline.degree_v, spline.rational};
    }

    void add_alone(const SurfaceQuery& query) { *query.point = tracer_.surface_point(*query.ray, *query.hit, detail_); }

    /// False where it is no hit on a patch that there is a version for.
    bool wait_for_patches(const SurfaceQuery& query, const InstanceRecord& record) {
        const auto* surface = shape_as<PatchSurface>(record, ShapeKind::PatchSurface);
        const SplinePatches* spline = surface ? &surface->spline_of(query.hit->local.primitive) : nullptr;
        if (!spline || !spline->smooth || !has_lanes(form_of(*spline))) return false;
        open_ |= 1u << count_;
        waiting_[count_++] = {&query, &record, surface, spline};
        if (count_ == kMost) finish_patches();
        return true;
    }
    void finish_patches() {
        while (open_ != 0) {
            const PatchForm form = form_of(*waiting_[static_cast<size_t>(__builtin_ctz(open_))].spline);
            for_each_lane(open_, [&](size_t i) {
                const Waiting& hit = waiting_[i];
                if (!(form_of(*hit.spline) == form)) return;
                open_ &= ~(1u << i);
                add_patch(patches_, *hit.query, *hit.record, *hit.surface, *hit.spline, mixed_);
                if (patches_.is_full()) place_patches(form);
            });
            place_patches(form);
        }
        count_ = 0;
    }
    void place_patches(const PatchForm& form) {
        place(patches_, [&](SurfaceLanes& lanes) {
            fill_up(lanes.count, lanes.points, lanes.strides, lanes.u, lanes.v, lanes.length_u, lanes.length_v);
            compute_patches(form, detail_, lanes);
        });
    }

    bool try_wall(const SurfaceQuery& query, const InstanceRecord& record) {
        const auto* surface = shape_as<SweptSurface>(record, ShapeKind::SweptSurface);
        if (!surface || detail_ != SurfaceDetail::Normal) return false;
        const LocalHit& hit = query.hit->local;
        const SweptElement element = surface->element(hit.primitive);
        const SweepPath& path = surface->path();
        if (element.part != SweptPart::Wall || !has_wall_lanes(path, path.pieces[element.piece])) return false;
        const WallPlace wall = surface->wall_place(hit, element);
        if (!wall.smooth) return false;
        add_wall(walls_, wall_lanes_, query, record, path, wall);
        if (walls_.is_full()) place_walls();
        return true;
    }
    void place_walls() {
        place(walls_, [&](SurfaceLanes& lanes) {
            fill_up(lanes.count, wall_lanes_);
            compute_walls(wall_lanes_, lanes);
        });
    }

    void place_others() {
        place(others_, [](SurfaceLanes& lanes) {
            fill_up_vectors(lanes.count, lanes.position, lanes.normal, lanes.dp_du, lanes.dp_dv, lanes.dn_du,
                            lanes.dn_dv);
        });
    }

    /// `complete` makes the local surfaces known in all lanes.
    template <typename Complete>
    void place(LaneGroup& group, const Complete& complete) {
        SurfaceLanes& lanes = group.lanes;
        if (lanes.count == 0) return;
        lanes.done = (1u << lanes.count) - 1;
        fill_up(lanes.count, lanes.records, lanes.size, lanes.float_error, lanes.vertex_error);
        fill_up_vectors(lanes.count, lanes.facet_position, lanes.facet_normal);
        complete(lanes);
        place_surfaces(detail_, lanes);
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
    for (const SurfaceQuery& query : queries) {
        query.point->sight.reset();
        if (query.hit->local.subpatch_length > 0.0f)
            query.point->sight = implementation_->sight_from(*query.ray, *query.hit);
    }
}

void Tracer::surface_points(std::span<const ElementQuery> queries) const {
    struct Chosen {
        Ray ray;
        Hit hit;
    };
    constexpr size_t kMost = SurfaceBatch::kMost;
    for (size_t first = 0; first < queries.size(); first += kMost) {
        SurfaceBatch batch(*this, SurfaceDetail::Normal);
        ShortList<Chosen, kMost> chosen;
        ShortList<SurfaceQuery, kMost> hits;
        for (const ElementQuery& query : queries.subspan(first, std::min(kMost, queries.size() - first))) {
            const InstanceRecord& record = implementation_->records[query.instance];
            if (record.motion) {
                *query.point = surface_point(query.instance, query.hit, query.time);
                continue;
            }
            Chosen& at = chosen.add();
            at.ray.origin = at.ray.direction = Vec3d(0.0);
            at.ray.time = query.time;
            at.hit.instance = query.instance;
            at.hit.local = query.hit;
            at.hit.local.time = shutter_time(query.time);
            at.hit.local = record.scene->on_facet(at.hit.local);
            batch.add(hits.add(&at.ray, &at.hit, query.point), record);
        }
        batch.finish();
        for (const SurfaceQuery& hit : hits) hit.point->sight.reset();
    }
}

}  // namespace rayleaf
