#include "trace/surface_lanes.h"

#include "base/simd.h"

#include <bit>
#include <cfloat>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/surface_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "trace/surface_vectors.inl"

/// What carries local vectors into the world.
struct Maps {
    Vec3 x, y, z;

    HWY_INLINE Vec3 apply(const Vec3& v) const { return times(x, v.x) + times(y, v.y) + times(z, v.z); }
};

/// The lanes from `first` on.
template <SurfaceDetail kDetail>
HWY_INLINE uint32_t place(SurfaceLanes& lanes, size_t first) {
    const auto row = [&](const double* numbers) HWY_ATTR { return hn::Load(Doubles(), numbers + first); };
    const OfEach<InstanceRecord> records(lanes.records + first);
    const InstanceRecord& record = records.first();
    const Affine3d& map = record.local_to_world;
    const Maps to_world{records.vector(map.x), records.vector(map.y), records.vector(map.z)};
    const Maps normals{records.vector(record.normal_x), records.vector(record.normal_y),
                       records.vector(record.normal_z)};
    const Vec3 translation = records.vector(map.translation);
    Mask sound = hn::FirstN(Doubles(), kWidth);

    store(Doubles(), to_world.apply(load(Doubles(), lanes.position, first)) + translation, lanes.position, first);
    const Vec3 start = to_world.apply(load(Doubles(), lanes.facet_position, first)) + translation;
    store(Doubles(), start, lanes.facet_position, first);
    const auto map_normal = [&](float(*rows)[SurfaceLanes::kMost])
                                HWY_ATTR { return normals.apply(to_doubles(load(Floats(), rows, first))); };
    const Vec3 facet_normal = to_doubles(to_floats(normalized(map_normal(lanes.facet_normal), sound)));
    store(Floats(), to_floats(facet_normal), lanes.facet_normal, first);
    const Vec3 mapped = map_normal(lanes.normal);
    const FloatVec3 normal = to_floats(normalized(mapped, sound));
    store(Floats(), normal, lanes.normal, first);
    for (auto* rows : {lanes.dp_du, lanes.dp_dv})
        store(Floats(), to_floats(to_world.apply(to_doubles(load(Floats(), rows, first)))), rows, first);
    if constexpr (kDetail == SurfaceDetail::Curvature) {
        const Double length = length_of(mapped, sound);
        const Vec3 n = to_doubles(normal);
        for (auto* rows : {lanes.dn_du, lanes.dn_dv}) {
            const Vec3 change = map_normal(rows);
            store(Floats(), to_floats(divided(change - times(n, dot(n, change)), length)), rows, first);
        }
    }

    const Vec3& n = facet_normal;
    const Double reach = length_of({dot(to_world.x, n), dot(to_world.y, n), dot(to_world.z, n)}, sound);
    const Double world = hn::Add(hn::Add(row(lanes.size), max_abs(start)), max_abs(translation));
    const Double rounding =
        hn::Add(hn::Mul(records.number(record.shear), world), records.number(record.sum_of_lengths));
    const Double offset =
        hn::Add(hn::Mul(row(lanes.float_error), reach), hn::Mul(all(InstanceRecord::kRoundingUnit), rounding));
    hn::Store(offset, Doubles(), lanes.start_offset + first);
    hn::Store(hn::Add(offset, hn::Mul(row(lanes.vertex_error), records.number(record.longest))), Doubles(),
              lanes.facet_error + first);
    return mask_bits(Doubles(), sound);
}

template <SurfaceDetail kDetail>
void place_all(SurfaceLanes& lanes) {
    uint32_t done = 0;
    for (size_t first = 0; first < lanes.count; first += kWidth) done |= place<kDetail>(lanes, first) << first;
    lanes.done &= done;
}

void place_lanes(SurfaceDetail detail, SurfaceLanes& lanes) {
    detail == SurfaceDetail::Curvature ? place_all<SurfaceDetail::Curvature>(lanes)
                                       : place_all<SurfaceDetail::Normal>(lanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(place_lanes);

void place_surfaces(SurfaceDetail detail, SurfaceLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(place_lanes)(detail, lanes);
}

}  // namespace rayleaf
#endif
