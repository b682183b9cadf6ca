#include "trace/instance_record.h"

#include "base/box_distance.h"
#include "base/largest.h"
#include "trace/inside_length.h"

namespace rayleaf {
namespace {

/// Whether a box is so near to a point; with a margin, for distances to places in it are taken in single precision.
bool is_within(const Box3d& box, const Vec3d& point, float reach) {
    return distance(box, point) <= 1.01 * reach;
}

/// Where rays of the picture that neighbour `ray` pass its object: as wide as the ray is there.
RayNeighbours neighbours_of(const Ray& ray, double t, double local_per_world) {
    return {static_cast<float>((ray.neighbour_distance + ray.neighbour_angle * std::max(t, 0.0)) * local_per_world),
            ray.neighbour_angle};
}

/// A unit normal in the world. Not inlined: where GCC 12 puts two numbers into one vector, it drops a rounding to float
/// that is followed by a conversion to double, and callers would go on with other numbers than they store.
[[gnu::noinline]] Vec3f world_normal(const InstanceRecord& record, const Vec3f& n) {
    return Vec3f(normalized_or(record.normal_to_world(Vec3d(n)), Vec3d(n)));
}

}  // namespace

void InstanceRecord::place(const Shape& shape, const Affine3d& object_to_world) {
    if (!try_place(shape, object_to_world))
        throw InputError(shape.name(), "size or place in the world",
                         "so small, large or far that doubles do not tell it", "lengths from 1e-100 to 1e100");
}

bool InstanceRecord::try_place(const Shape& shape, const Affine3d& object_to_world) {
    local_to_world = object_to_world * shape.frame().to_object();
    const Affine3d inverse = local_to_world.inverse();
    to_local = {local_to_world.translation, inverse.x, inverse.y, inverse.z};
    const bool usable =
        is_finite(inverse.x) && is_finite(inverse.y) && is_finite(inverse.z) && is_place(local_to_world.translation);
    if (!usable) return false;
    const double lengths[3] = {local_to_world.x.length(), local_to_world.y.length(), local_to_world.z.length()};
    longest = std::max({lengths[0], lengths[1], lengths[2]});
    shrink = static_cast<float>(1.0 / longest);
    widening = static_cast<float>(std::min({lengths[0], lengths[1], lengths[2]}) / longest);
    sum_of_lengths = lengths[0] + lengths[1] + lengths[2];
    shear = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        shear += lengths[axis] * Vec3d(to_local.x[axis], to_local.y[axis], to_local.z[axis]).length();
    // A map that mirrors turns the winding.
    const double turned = local_to_world.determinant() < 0.0 ? -1.0 : 1.0;
    normal_x = local_to_world.normal({1, 0, 0}) * turned;
    normal_y = local_to_world.normal({0, 1, 0}) * turned;
    normal_z = local_to_world.normal({0, 0, 1}) * turned;
    return true;
}

const InstanceRecord* InstanceRecord::moved(float time, Maybe<InstanceRecord>& room) const {
    InstanceRecord& record = room.emplace(*this);
    return record.try_place(scene->shape(), motion->at(time)) ? &record : nullptr;
}

Box3d InstanceRecord::world_box() const {
    if (motion) return motion->bounds(image_of(scene->box(), scene->shape().frame().to_object()));
    return scene->image(local_to_world);
}

/// First, the ray that is tested must lie on the true ray's side of the facet: a ray that leaves at a grazing angle and
/// runs outside a closed surface for that error would never find the neighbouring facet that it should hit. A local
/// error moves the point along the facet's normal by at most the length of the normal's image under the transposed map.
/// Second, what was computed in double is rounded by 2^-53 of the numbers involved: the world coordinates of the point
/// and of the ray that found it (`size`), the translation, and local ones of the order of 1, which the map enlarges by
/// the sum of its axes. Each local axis takes part with the length of its row in the inverse times its column, 3 in all
/// unless the map shears. The factor 64 covers the number of operations.
double InstanceRecord::start_offset(const Vec3d& position, const Vec3d& normal, double size) const {
    const Affine3d& map = local_to_world;
    const double float_error =
        scene->float_error() * Vec3d(map.x.dot(normal), map.y.dot(normal), map.z.dot(normal)).length();
    const double world = size + max_abs(position) + max_abs(map.translation);
    return float_error + kRoundingUnit * (shear * world + sum_of_lengths);
}

ObjectAnswer InstanceRecord::ask(const Ray& world_ray, const LocalRay& ray, const RayDifferential* differential) const {
    RayNeighbours neighbours = neighbours_of(world_ray, ray.start, ray.speed);
    RayDifferential local;
    if (differential) {
        local = local_differential(world_ray, ray, *differential);
        neighbours.differential = &local;
    }
    return cache->ask(ray.origin + ray.direction * world_ray.t_min, ray.direction / ray.speed, neighbours);
}

/// Where the ray asked begins, at t_min of the world ray.
RayDifferential InstanceRecord::local_differential(const Ray& world_ray, const LocalRay& ray,
                                                   const RayDifferential& differential) const {
    const Vec3d unit = ray.direction / ray.speed;
    const auto position = [&](const Vec3f& dp, const Vec3f& dd) {
        return Vec3f(vector_to_local(Vec3d(dp) + Vec3d(dd) * world_ray.t_min));
    };
    const auto direction = [&](const Vec3f& dd) {
        const Vec3d change = vector_to_local(Vec3d(dd));
        return Vec3f((change - unit * unit.dot(change)) / ray.speed);
    };
    const RayDifferential& world = differential;
    return {position(world.dp_dx, world.dd_dx), position(world.dp_dy, world.dd_dy), direction(world.dd_dx),
            direction(world.dd_dy)};
}

LocalHit InstanceRecord::interpolated_local(const Ray& world_ray, double t, const ObjectAnswer& answer) const {
    LocalHit hit;
    hit.primitive = answer.primitive;
    hit.u = hit.v = 0.25f;  // anywhere on the element: it stands for its material
    hit.position = point_to_local(world_ray.origin) + vector_to_local(world_ray.direction) * t;
    hit.normal = Vec3f(answer.normal);
    return hit;
}

RayBeam InstanceRecord::local_beam(const RayBeam& beam) const {
    RayBeam local;
    for (int i = 0; i < 2; ++i) {
        const RayBeam::Side& world = beam.sides[i];
        local.sides[i] = {world.a * shrink * shrink, world.b * shrink * widening, world.c * widening * widening};
    }
    return local;
}

Maybe<LocalRay> InstanceRecord::local_ray(uint32_t index, const Ray& world_ray, double t_max) const {
    Maybe<LocalRay> local = clipped_ray(scene->box(), point_to_local(world_ray.origin),
                                        vector_to_local(world_ray.direction), world_ray.t_min, t_max);
    if (!local) return local;
    local->time = shutter_time(world_ray.time);
    if (world_ray.start.instance == index) local->start_facet = world_ray.start.facet;
    if (!scene->has_levels()) return local;
    local->beam = local_beam(world_ray.beam);
    local->stretch = 1.0f / widening;
    const Maybe<RaySight>& before = world_ray.start.sight;
    if (before && is_within(scene->box(), local->origin, before->reach * shrink))
        local->before.emplace(LocalSight{point_to_local(before->origin), vector_to_local(before->direction),
                                         local_beam(before->beam), before->reach * shrink});
    if (world_ray.start.instance == index) local->anchors[0] = world_ray.start;
    if (world_ray.end.instance == index) local->anchors[1] = world_ray.end;
    return local;
}

Maybe<Hit> InstanceRecord::closest(uint32_t index, const Ray& world_ray) const {
    Maybe<Hit> found;
    const Maybe<LocalRay> local = local_ray(index, world_ray, world_ray.t_max);
    ShapeHit hit;
    if (local && scene->closest(*local, hit))
        found.emplace(hit.point.t, index, RayAnswer::NotAsked).local = scene->hit_at(hit, local->time);
    return found;
}

LengthAnswer InstanceRecord::length_inside(const Ray& world_ray) const {
    if (scene->box().isEmpty()) return {RayAnswer::NotAsked};
    const Vec3d origin = point_to_local(world_ray.origin), direction = vector_to_local(world_ray.direction);
    const std::optional<RayInterval> interval = inside_box(scene->box(), origin, direction);
    if (!interval || interval->end < world_ray.t_min || interval->begin > world_ray.t_max) return {RayAnswer::NotAsked};
    if (cache && interval->end <= world_ray.t_max) {
        const double speed = direction.length();
        LengthAnswer answer = cache->ask_length(origin + direction * world_ray.t_min, direction / speed,
                                                neighbours_of(world_ray, interval->begin, speed));
        answer.length /= speed;
        if (answer.answer != RayAnswer::Traced) return answer;
    }
    return {cache ? RayAnswer::Traced : RayAnswer::NotAsked,
            traced_length(*scene, origin, direction, shutter_time(world_ray.time), world_ray.t_min, world_ray.t_max),
            0.0f};
}

/// Derivative of N = m/|m|, m the mapped normal: (m' - N (N.m')) / |m|.
void InstanceRecord::set_curvature(const LocalSurface& local, SurfacePoint& point) const {
    const double length = normal_to_world(Vec3d(local.normal)).length();
    const auto normal_derivative = [&](const Vec3f& dn) {
        const Vec3d change = normal_to_world(Vec3d(dn)), n(point.normal);
        return length > 0.0 ? Vec3f((change - n * n.dot(change)) / length) : Vec3f(0.0f);
    };
    point.dn_du = normal_derivative(local.dn_du);
    point.dn_dv = normal_derivative(local.dn_dv);
}

SurfacePoint InstanceRecord::facet_point(uint32_t index, const LocalHit& hit, double size) const {
    SurfacePoint point;
    point.shape = &scene->shape();
    point.local = hit;
    point.instance = index;
    point.position = point.facet_position = local_to_world.point(hit.position);
    point.normal = point.facet_normal = world_normal(*this, hit.normal);
    point.start_offset = start_offset(point.facet_position, Vec3d(point.facet_normal), size);
    point.facet_error = point.start_offset + scene->vertex_error() * longest;
    return point;
}

SurfacePoint InstanceRecord::surface_point(uint32_t index, const LocalHit& hit, double size,
                                           const InterpolatedHit* interpolated, SurfaceDetail detail) const {
    const Affine3d& map = local_to_world;
    LocalSurface local{hit.position, hit.normal};
    if (interpolated) {
        local.uv = interpolated->uv;
        local.dn_du = interpolated->changes.steps[0].normal;
        local.dn_dv = interpolated->changes.steps[1].normal;
    } else {
        local = local_surface(hit, detail);
    }

    SurfacePoint point = facet_point(index, hit, size);
    point.position = map.point(local.position);
    point.normal = world_normal(*this, local.normal);
    point.dp_du = Vec3f(map.vector(Vec3d(local.dp_du)));
    point.dp_dv = Vec3f(map.vector(Vec3d(local.dp_dv)));
    if (detail == SurfaceDetail::Curvature) set_curvature(local, point);
    point.uv = local.uv;
    // A ray that leaves must not meet the surface beside which the point may lie.
    if (interpolated) {
        point.interpolated = true;
        point.uv_by_u = interpolated->changes.steps[0].uv;
        point.uv_by_v = interpolated->changes.steps[1].uv;
        point.start_offset += (interpolated->position_error + scene->facet_distance()) * longest;
    }
    return point;
}

}  // namespace rayleaf
