// The surface points of many hits: those on spline patches over lanes, the others one by one.
#include "geometry/patch_surface.h"
#include "trace/surface_lanes.h"
#include "trace/tracer_queries.h"

#include <array>
#include <optional>

namespace rayleaf {
namespace {

/// Hits that one kernel does together, and what it does not need to know of them.
struct LaneGroup {
    SurfaceLanes lanes;
    std::array<const SurfaceQuery*, SurfaceLanes::kMost> queries;
    std::array<Vec2f, SurfaceLanes::kMost> uv;
    std::array<std::optional<InstanceRecord>, SurfaceLanes::kMost> moved;  ///< records of instances that move
    /// Patches at the hits' times, of surfaces that deform.
    std::array<std::array<Vec4d, SurfaceLanes::kMostPoints>, SurfaceLanes::kMost> mixed;
};

/// Fewer are done one by one.
constexpr size_t kLeastLanes = 3;

const PatchSurface* patches_of(const InstanceRecord& record, const Hit& hit) {
    const Shape& shape = record.scene->shape();
    if (hit.is_interpolated() || shape.kind() != ShapeKind::PatchSurface) return nullptr;
    return static_cast<const PatchSurface*>(&shape);
}

void add(LaneGroup& group, const SurfaceQuery& query, const InstanceRecord& record, const PatchSurface& surface,
         const SplinePatches& spline) {
    SurfaceLanes& lanes = group.lanes;
    const size_t i = lanes.count++;
    const LocalHit& hit = query.hit->local;
    const SplineSpan &u = spline.span_u(hit.primitive), &v = spline.span_v(hit.primitive);
    group.queries[i] = &query;
    group.uv[i] = Vec2f(static_cast<float>(u.begin + hit.u * (u.end - u.begin)),
                        static_cast<float>(v.begin + hit.v * (v.end - v.begin)));
    lanes.points[i] = surface.patch(hit.primitive, spline).points;
    if (surface.deforms()) {
        surface.mix_points(hit.primitive, spline, hit.time, group.mixed[i].data());
        lanes.points[i] = group.mixed[i].data();
    }
    lanes.records[i] = record.at(query.ray->time, group.moved[i]);
    lanes.u[i] = hit.u;
    lanes.v[i] = hit.v;
    lanes.length_u[i] = u.end - u.begin;
    lanes.length_v[i] = v.end - v.begin;
    for (int axis = 0; axis < 3; ++axis) {
        lanes.facet_position[axis][i] = hit.position[axis];
        lanes.facet_normal[axis][i] = hit.normal[axis];
    }
    lanes.size[i] = max_abs(query.ray->origin) + query.hit->t * max_abs(query.ray->direction);
    lanes.float_error[i] = record.scene->float_error();
    lanes.vertex_error[i] = record.scene->vertex_error();
}

/// Repeats the last hit in the lanes beyond it.
void fill_up(SurfaceLanes& lanes) {
    const size_t last = lanes.count - 1;
    for (size_t i = lanes.count; i < SurfaceLanes::kMost; ++i) {
        lanes.points[i] = lanes.points[last];
        lanes.records[i] = lanes.records[last];
        for (double* row :
             {lanes.u, lanes.v, lanes.length_u, lanes.length_v, lanes.size, lanes.float_error, lanes.vertex_error,
              lanes.facet_position[0], lanes.facet_position[1], lanes.facet_position[2]})
            row[i] = row[last];
        for (auto& row : lanes.facet_normal) row[i] = row[last];
    }
}

Vec3d double_row(const double (&rows)[3][SurfaceLanes::kMost], size_t i) {
    return {rows[0][i], rows[1][i], rows[2][i]};
}
Vec3f float_row(const float (&rows)[3][SurfaceLanes::kMost], size_t i) {
    return {rows[0][i], rows[1][i], rows[2][i]};
}

void take(const LaneGroup& group, size_t i, SurfaceDetail detail) {
    const SurfaceLanes& lanes = group.lanes;
    const Hit& hit = *group.queries[i]->hit;
    SurfacePoint point;
    point.t = hit.t;
    point.time = group.queries[i]->ray->time;
    point.shape = &lanes.records[i]->scene->shape();
    point.local = hit.local;
    point.instance = hit.instance;
    point.uv = group.uv[i];
    point.position = double_row(lanes.position, i);
    point.facet_position = double_row(lanes.facet_position_out, i);
    point.start_offset = lanes.start_offset[i];
    point.facet_error = lanes.facet_error[i];
    point.facet_normal = float_row(lanes.facet_normal_out, i);
    point.normal = float_row(lanes.normal, i);
    point.dp_du = float_row(lanes.dp_du, i);
    point.dp_dv = float_row(lanes.dp_dv, i);
    if (detail == SurfaceDetail::Curvature) {
        point.dn_du = float_row(lanes.dn_du, i);
        point.dn_dv = float_row(lanes.dn_dv, i);
    }
    *group.queries[i]->point = point;
}

/// Hits of one call, those on patches of one form together.
class SurfaceBatch {
  public:
    static constexpr size_t kMost = 32;

    SurfaceBatch(const Tracer& tracer, SurfaceDetail detail) : tracer_(tracer), detail_(detail) {}

    void add(const SurfaceQuery& query, const InstanceRecord& record) {
        const PatchSurface* surface = patches_of(record, *query.hit);
        const SplinePatches* spline = surface ? &surface->spline_of(query.hit->local.primitive) : nullptr;
        if (!spline || !spline->smooth) return add_alone(query);
        const PatchForm form{spline->degree_u, spline->degree_v, spline->rational};
        if (!has_lanes(form)) return add_alone(query);
        open_ |= 1u << count_;
        waiting_[count_++] = {&query, &record, surface, spline, form};
        if (count_ == kMost) finish();
    }
    void finish() {
        while (open_ != 0) {
            const PatchForm& form = waiting_[static_cast<size_t>(__builtin_ctz(open_))].form;
            for_each_lane(open_, [&](size_t i) {
                const Waiting& hit = waiting_[i];
                if (!(hit.form == form)) return;
                open_ &= ~(1u << i);
                rayleaf::add(group_, *hit.query, *hit.record, *hit.surface, *hit.spline);
                if (group_.lanes.count == SurfaceLanes::kMost) compute(form);
            });
            compute(form);
        }
        count_ = 0;
    }

  private:
    struct Waiting {
        const SurfaceQuery* query;
        const InstanceRecord* record;
        const PatchSurface* surface;
        const SplinePatches* spline;
        PatchForm form;
    };
    const Tracer& tracer_;
    SurfaceDetail detail_;
    std::array<Waiting, kMost> waiting_;
    size_t count_ = 0;
    uint32_t open_ = 0;  ///< of those that wait, a bit each
    LaneGroup group_;

    void add_alone(const SurfaceQuery& query) { *query.point = tracer_.surface_point(*query.ray, *query.hit, detail_); }

    void compute(const PatchForm& form) {
        SurfaceLanes& lanes = group_.lanes;
        lanes.done = 0;
        if (lanes.count >= kLeastLanes) {
            fill_up(lanes);
            compute_surfaces(form, detail_, lanes);
        }
        for (size_t i = 0; i < lanes.count; ++i) {
            if ((lanes.done >> i & 1u) != 0)
                take(group_, i, detail_);
            else
                add_alone(*group_.queries[i]);
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
        if (query.hit->local.subpatch_length > 0.0f)
            query.point->sight = implementation_->sight_from(*query.ray, *query.hit);
}

}  // namespace rayleaf
