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

/// Gathers hits until a kernel's lanes are full.
class SurfaceBatch {
  public:
    SurfaceBatch(const Tracer& tracer, SurfaceDetail detail) : tracer_(tracer), detail_(detail) {}

    void add(const SurfaceQuery& query, const InstanceRecord& record) {
        const PatchSurface* surface = patches_of(record, *query.hit);
        const SplinePatches* spline = surface ? &surface->spline_of(query.hit->local.primitive) : nullptr;
        if (!spline || !spline->smooth || !has_lanes(spline->degree_u, spline->degree_v)) return add_alone(query);
        LaneGroup& group = groups_[spline->degree_u - 2][spline->rational ? 1 : 0];
        rayleaf::add(group, query, record, *surface, *spline);
        if (group.lanes.count == SurfaceLanes::kMost) compute(group, spline->degree_u, spline->rational);
    }
    void finish() {
        for (const int degree : {2, 3})
            for (const bool rational : {false, true}) compute(groups_[degree - 2][rational ? 1 : 0], degree, rational);
    }

  private:
    const Tracer& tracer_;
    SurfaceDetail detail_;
    LaneGroup groups_[2][2];  ///< by degree from 2 on, and rationality

    void add_alone(const SurfaceQuery& query) { *query.point = tracer_.surface_point(*query.ray, *query.hit, detail_); }

    void compute(LaneGroup& group, int degree, bool rational) {
        group.lanes.done = 0;
        if (group.lanes.count >= kLeastLanes) {
            fill_up(group.lanes);
            compute_surfaces(degree, rational, detail_, group.lanes);
        }
        for (size_t i = 0; i < group.lanes.count; ++i) {
            if ((group.lanes.done >> i & 1u) != 0)
                take(group, i, detail_);
            else
                add_alone(*group.queries[i]);
        }
        group.lanes.count = 0;
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
