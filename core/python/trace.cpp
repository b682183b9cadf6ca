#include "geometry/patch_surface.h"
#include "geometry/swept_curve_making.h"
#include "geometry/swept_surface.h"
#include "geometry/triangle_mesh.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/dicing_view.h"
#include "python/geometry_cache.h"
#include "python/motions.h"
#include "python/packets.h"
#include "python/ray_footprints.h"
#include "python/timed_rays.h"
#include "tessellation/grid_intersection.h"
#include "tessellation/patch_dicer.h"
#include "tessellation/simd_targets.h"
#include "trace/tracer.h"

#include <map>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

using SampledDirection = std::tuple<int, bool, bool, bool>;

/// `points` (count_v, count_u, 4): x, y, z, weight; directions: order, cyclic, endpoint, bezier.
NurbsSpline make_spline(const Array<double>& points, const SampledDirection& u, const SampledDirection& v, bool smooth,
                        int slot) {
    check_shape("spline", "points", points, {-1, -1, 4});
    NurbsSpline spline;
    spline.surface.count_v = static_cast<int>(points.shape(0));
    spline.surface.count_u = static_cast<int>(points.shape(1));
    for (py::ssize_t i = 0; i < points.size(); i += 4) {
        const double* p = points.data() + i;
        spline.surface.points.emplace_back(p[0], p[1], p[2], p[3]);
    }
    const auto direction = [](const SampledDirection& d) {
        return NurbsDirection{std::get<0>(d), std::get<1>(d), std::get<2>(d), std::get<3>(d)};
    };
    spline.surface.u = direction(u);
    spline.surface.v = direction(v);
    spline.smooth = smooth;
    spline.material_slot = slot;
    return spline;
}

using SplineArguments = std::tuple<Array<double>, SampledDirection, SampledDirection, bool, int>;

std::shared_ptr<PatchSurface> make_surface(const std::string& name, const std::vector<SplineArguments>& splines) {
    std::vector<NurbsSpline> made;
    made.reserve(splines.size());
    for (const auto& [points, u, v, smooth, slot] : splines) made.push_back(make_spline(points, u, v, smooth, slot));
    return std::make_shared<PatchSurface>(name, made);
}

using Placement = std::tuple<std::shared_ptr<Shape>, Array<double>, int>;

std::shared_ptr<TriangleMesh> make_mesh(const std::string& name, const Array<float>& vertices,
                                        const Array<int32_t>& triangles, const Array<float>& corner_normals,
                                        const Array<int32_t>& material_slots, const Array<float>& uv) {
    check_numbers(name, "vertices", vertices);
    check_numbers(name, "triangles", triangles);
    check_numbers(name, "corner_normals", corner_normals);
    check_numbers(name, "material_slots", material_slots);
    check_numbers(name, "uv", uv);
    TriangleMeshArrays arrays;
    arrays.name = name;
    arrays.vertices = span_of(vertices);
    arrays.triangles = span_of(triangles);
    arrays.corner_normals = span_of(corner_normals);
    arrays.material_slots = span_of(material_slots);
    if (uv.size() > 0) {
        arrays.active_uv = 0;
        arrays.attributes.push_back({0, 2, std::vector<float>(uv.data(), uv.data() + uv.size())});
    }
    return std::make_shared<TriangleMesh>(std::move(arrays));
}

std::unique_ptr<Tracer> make_tracer(const std::vector<Placement>& placements, double pixel_angle,
                                    const std::array<double, 3>& eye, const GeometryCacheSettings& cache,
                                    const std::map<size_t, Array<double>>& motions) {
    std::vector<TracedInstance> instances;
    instances.reserve(placements.size());
    for (const auto& [shape, matrix, visibility] : placements) {
        if (!shape) throw InputError("tracer", "instances", "one without a shape", "(shape, matrix, visibility)");
        instances.push_back({shape, affine_of(shape->name(), matrix), static_cast<uint8_t>(visibility)});
    }
    for (const auto& [index, matrices] : motions) {
        if (index >= instances.size())
            throw InputError("tracer", "motions", std::to_string(index), "indices of instances");
        instances[index].motion = motion_of(instances[index].shape->name(), matrices);
    }
    const py::gil_scoped_release released;
    return std::make_unique<Tracer>(std::move(instances), view_from(pixel_angle, eye), kNeverCancelled, cache);
}

py::array_t<double> moved(const Array<double>& matrices, float time) {
    const std::shared_ptr<const Motion> motion = motion_of("motion", matrices);
    const Affine3d place = motion ? motion->at(time) : affine_of("motion", matrices.data());
    py::array_t<double> result(std::vector<size_t>{4, 4});
    double* out = result.mutable_data();
    for (int row = 0; row < 3; ++row) {
        const double numbers[4] = {place.x[row], place.y[row], place.z[row], place.translation[row]};
        std::copy_n(numbers, 4, out + 4 * row);
    }
    const double last[4] = {0, 0, 0, 1};
    std::copy_n(last, 4, out + 12);
    return result;
}

/// Many instances of one shape: matrices (n, 4, 4).
std::unique_ptr<Tracer> make_instanced(const std::shared_ptr<Shape>& shape, const Array<double>& matrices) {
    check_shape(shape->name(), "matrices", matrices, {-1, 4, 4});
    std::vector<TracedInstance> instances;
    instances.reserve(static_cast<size_t>(matrices.shape(0)));
    for (py::ssize_t i = 0; i < matrices.shape(0); ++i)
        instances.push_back({shape, affine_of(shape->name(), matrices.data() + 16 * i), kVisibleAll});
    const py::gil_scoped_release released;
    return std::make_unique<Tracer>(std::move(instances), DicingView{});
}

template <typename T>
py::array_t<T> columns(size_t rows, size_t count) {
    return py::array_t<T>(std::vector<size_t>{rows, count});
}

template <typename V, typename T>
void store_vector(const V& value, T* out) {
    for (int i = 0; i < 3; ++i) out[i] = value[i];
}

py::dict closest_hits(const Tracer& tracer, const Array<double>& origins, const Array<double>& directions,
                      const Array<double>& t_min, const Array<double>& t_max, int kind, const Array<float>& width,
                      const Array<float>& spread, const Array<uint32_t>& starts, size_t together,
                      const Array<float>& times, bool curvature) {
    const RayArrays rays{origins, directions, t_min, t_max, width, spread, starts, times};
    rays.check();
    const size_t n = rays.size();
    if (together < 1) throw InputError("rays", "together", "0", "at least 1");
    py::array_t<uint32_t> anchors = columns<uint32_t>(n, 4);
    uint32_t* anchors_out = anchors.mutable_data();
    py::array_t<double> t(n), offset(n), position = columns<double>(n, 3), facet = columns<double>(n, 3);
    py::array_t<int32_t> instance(n), primitive(n);
    py::array_t<float> u(n), v(n), normal = columns<float>(n, 3), facet_normal = columns<float>(n, 3);
    py::array_t<float> uv = columns<float>(n, 2);
    py::array_t<float> derivatives(std::vector<size_t>{n, 4, 3});
    double *t_out = t.mutable_data(), *offset_out = offset.mutable_data();
    double *position_out = position.mutable_data(), *facet_out = facet.mutable_data();
    int32_t *instance_out = instance.mutable_data(), *primitive_out = primitive.mutable_data();
    float *u_out = u.mutable_data(), *v_out = v.mutable_data(), *uv_out = uv.mutable_data();
    float *normal_out = normal.mutable_data(), *facet_normal_out = facet_normal.mutable_data();
    float* derivatives_out = derivatives.mutable_data();
    const auto store = [&](size_t i, const Maybe<Hit>& hit, const SurfacePoint& point) {
        t_out[i] = hit ? hit->t : std::numeric_limits<double>::infinity();
        instance_out[i] = hit ? static_cast<int32_t>(hit->instance) : -1;
        primitive_out[i] = hit ? static_cast<int32_t>(hit->local.primitive) : -1;
        u_out[i] = hit ? hit->local.u : 0.0f;
        v_out[i] = hit ? hit->local.v : 0.0f;
        offset_out[i] = point.start_offset;
        store_vector(point.position, position_out + 3 * i);
        store_vector(point.facet_position, facet_out + 3 * i);
        store_vector(point.normal, normal_out + 3 * i);
        store_vector(point.facet_normal, facet_normal_out + 3 * i);
        uv_out[2 * i] = point.uv.x;
        uv_out[2 * i + 1] = point.uv.y;
        const RayAnchor anchor = hit ? point.anchor() : RayAnchor{};
        anchors_out[4 * i] = anchor.instance;
        anchors_out[4 * i + 1] = anchor.subpatch;
        anchors_out[4 * i + 2] = anchor.levels;
        anchors_out[4 * i + 3] = anchor.facet;
        const Vec3f* const slopes[] = {&point.dp_du, &point.dp_dv, &point.dn_du, &point.dn_dv};
        for (size_t k = 0; k < 4; ++k) store_vector(*slopes[k], derivatives_out + 12 * i + 3 * k);
    };
    const SurfaceDetail detail = curvature ? SurfaceDetail::Curvature : SurfaceDetail::Normal;
    const auto trace = [&](size_t first) {
        std::vector<Ray> chunk;
        for (size_t i = first; i < std::min(first + together, n); ++i) chunk.push_back(rays[i]);
        const FoundPoints found = found_points(tracer, chunk, static_cast<Visibility>(kind), detail);
        for (size_t i = 0; i < chunk.size(); ++i) store(first + i, found.hits[i], found.points[i]);
    };
    {
        const py::gil_scoped_release released;
        tbb::parallel_for(size_t{0}, (n + together - 1) / together, [&](size_t i) { trace(i * together); });
    }
    py::dict result;
    result["t"] = t;
    result["instance"] = instance;
    result["primitive"] = primitive;
    result["u"] = u;
    result["v"] = v;
    result["uv"] = uv;
    result["position"] = position;
    result["facet_position"] = facet;
    result["normal"] = normal;
    result["facet_normal"] = facet_normal;
    result["start_offset"] = offset;
    result["derivatives"] = derivatives;
    result["anchors"] = anchors;
    return result;
}

py::array_t<bool> occluded(const Tracer& tracer, const Array<double>& origins, const Array<double>& directions,
                           const Array<double>& t_min, const Array<double>& t_max, int kind,
                           const Array<float>& times) {
    const RayArrays rays = ray_arrays(origins, directions, t_min, t_max, times);
    py::array_t<bool> result(rays.size());
    bool* out = result.mutable_data();
    const py::gil_scoped_release released;
    tbb::parallel_for(size_t{0}, rays.size(),
                      [&](size_t i) { out[i] = tracer.occluded(rays[i], static_cast<Visibility>(kind)); });
    return result;
}

PatchDicer unsplit(const PatchSurface& surface) {
    return PatchDicer(surface, [](const Box3d&) { return std::numeric_limits<double>::infinity(); });
}

void check_patch(const PatchSurface& surface, uint32_t patch) {
    if (patch >= surface.element_count())
        throw InputError(surface.name(), "patch", std::to_string(patch),
                         "a patch below " + std::to_string(surface.element_count()));
}

py::tuple normal_at(const PatchSurface& surface, uint32_t patch, float u, float v) {
    check_patch(surface, patch);
    LocalHit hit;
    hit.primitive = patch;
    hit.u = u;
    hit.v = v;
    const Vec3f normal = surface.surface(hit).normal;
    return py::make_tuple(std::array<float, 3>{normal.x, normal.y, normal.z}, surface.limit_normals().counts);
}

/// The grid of one patch that is not split, as (17, 17, 3): rows run along v.
py::array_t<float> diced_patch(const PatchSurface& surface, uint32_t patch) {
    check_patch(surface, patch);
    Grid grid;
    unsplit(surface).dice(patch, grid);
    py::array_t<float> result(std::vector<size_t>{kGridVertices, kGridVertices, 3});
    for (int k = 0; k < kGridSize; ++k)
        store_vector(grid.vertex(k % kGridVertices, k / kGridVertices), result.mutable_data() + 3 * k);
    return result;
}

/// The first candidates of rays (n, 3) in the grid of one patch that is not split, in its local space: t and triangle,
/// -1 where there is none.
py::tuple grid_candidates(const PatchSurface& surface, uint32_t patch, const Array<float>& origins,
                          const Array<float>& directions) {
    check_patch(surface, patch);
    check_shape(surface.name(), "origins", origins, {-1, 3});
    check_shape(surface.name(), "directions", directions, {origins.shape(0), 3});
    Grid grid;
    unsplit(surface).dice(patch, grid);
    const GridKernels kernels = grid_kernels();
    const py::ssize_t count = origins.size() / 3;
    py::array_t<float> t(count);
    py::array_t<int32_t> triangle(count);
    for (py::ssize_t i = 0; i < count; ++i) {
        const float *o = origins.data() + 3 * i, *d = directions.data() + 3 * i;
        GridCandidates candidates;
        kernels.add_candidates(SnappedGrid(grid), GridRay({o[0], o[1], o[2]}, {d[0], d[1], d[2]}),
                               std::numeric_limits<float>::infinity(), candidates);
        GridCandidate nearest{std::numeric_limits<float>::infinity(), 0};
        const bool found = !candidates.empty();
        if (found) nearest = candidates.take_nearest();
        t.mutable_data()[i] = nearest.t;
        triangle.mutable_data()[i] = found ? static_cast<int32_t>(nearest.triangle) : -1;
    }
    return py::make_tuple(t, triangle);
}

py::array_t<double> rings(const SweptSurface& surface, const Array<double>& places) {
    check_shape(surface.name(), "places", places, {-1});
    py::array_t<double> result(std::vector<size_t>{static_cast<size_t>(places.size()), 6, 3});
    const std::vector<SweepPiece>& pieces = surface.path().pieces;
    for (py::ssize_t i = 0; i < places.size(); ++i) {
        const auto piece =
            std::clamp(static_cast<int64_t>(places.data()[i]), int64_t{0}, static_cast<int64_t>(pieces.size()) - 1);
        const SweepRingPoint point =
            surface.path().evaluate(pieces[static_cast<size_t>(piece)], places.data()[i] - static_cast<double>(piece));
        const Vec3d vectors[6] = {point.ring.center,   point.ring.across,   point.ring.up,
                                  point.change.center, point.change.across, point.change.up};
        for (int k = 0; k < 6; ++k) store_vector(vectors[k], result.mutable_data() + 18 * i + 3 * k);
    }
    return result;
}

py::tuple timed(const Tracer& tracer, const Array<double>& origins, const Array<double>& directions,
                const Array<float>& width, const Array<float>& spread, const Array<uint32_t>& starts) {
    const std::vector<Ray> rays = whole_rays(origins, directions, width, spread, starts);
    return timed_rays(rays, [&](const Ray& ray) {
        const Maybe<Hit> hit = tracer.closest_hit(ray, kVisibleAll);
        return hit ? hit->t : std::numeric_limits<double>::infinity();
    });
}

py::dict tracer_statistics(const Tracer& tracer) {
    const TraceStatistics s = tracer.statistics();
    py::dict result;
    result["subpatches"] = s.subpatches;
    result["record_bytes"] = s.record_bytes;
    result["facet_bytes"] = s.facet_bytes;
    result["geometry_cache"] = geometry_cache_statistics(s.geometry);
    result["bvh_bytes"] = s.bvh_bytes;
    result["triangles"] = s.triangles;
    result["instances"] = s.instances;
    result["shapes"] = s.shapes;
    result["opened_instances"] = s.opened_instances;
    return result;
}

/// True, or an error that names those there are.
bool choose_simd_target(const std::string& name) {
    if (use_simd_target(name)) return true;
    std::string known;
    for (const std::string& each : simd_targets()) known += each + ", ";
    throw InputError("simd", "name", "'" + name + "'", "one of " + known + "or nothing");
}

py::tuple bounds(const Tracer& tracer) {
    const Box3d box = tracer.bounds();
    return py::make_tuple(std::array{box.min.x, box.min.y, box.min.z}, std::array{box.max.x, box.max.y, box.max.z});
}

}  // namespace

void bind_trace(py::module_& parent) {
    py::module_ module = parent.def_submodule("trace", "Shapes and rays against them, for tests and benchmarks.");
    bind_geometry_cache_settings(module);
    py::class_<Shape, std::shared_ptr<Shape>>(module, "Shape", "A renderable shape in its own space.")
        .def_property_readonly("name", &Shape::name)
        .def_property_readonly("element_count", &Shape::element_count)
        .def_property_readonly(
            "frame",
            [](const Shape& shape) {
                const LocalFrame& frame = shape.frame();
                return py::make_tuple(std::array{frame.center.x, frame.center.y, frame.center.z}, frame.scale);
            },
            "(center, scale): object space is local space times scale plus center.")
        .def_property_readonly("bytes", &Shape::bytes);
    py::class_<TriangleMesh, Shape, std::shared_ptr<TriangleMesh>>(module, "TriangleMesh", "A triangle mesh.")
        .def(py::init(&make_mesh), py::arg("name"), py::arg("vertices"), py::arg("triangles"),
             py::arg("corner_normals") = Array<float>(0), py::arg("material_slots") = Array<int32_t>(0),
             py::arg("uv") = Array<float>(0));

    py::class_<PatchSurface, Shape, std::shared_ptr<PatchSurface>>(module, "PatchSurface",
                                                                   "A surface of NURBS splines.")
        .def(py::init(&make_surface), py::arg("name"), py::arg("splines"),
             "splines: (points (count_v, count_u, 4), direction u, direction v, smooth, material slot) each; a "
             "direction "
             "is (order, cyclic, endpoint, bezier)")
        .def("normal_at", &normal_at, py::arg("patch"), py::arg("u"), py::arg("v"),
             "Shading normal and the number of limit normals by stage so far, for a hit on a facet that faces +z.");

    py::class_<SweptSurface, Shape, std::shared_ptr<SweptSurface>>(module, "SweptSurface", "A bevelled curve.")
        .def(py::init([](const SweptCurve& curve) { return curve.surface(); }), py::arg("curve"))
        .def("rings", &rings, py::arg("places"),
             "Centre, x and y direction, and their derivatives, (n, 6, 3) in local space, at (n) places: piece + u.");

    const Array<double> zero = number(0.0), infinity = number(std::numeric_limits<double>::infinity());
    py::class_<Tracer>(module, "Tracer", "Rays against instances: (shape, 4x4 matrix, visibility) each.")
        .def(py::init(&make_tracer), py::arg("instances"), py::arg("pixel_angle") = 1e-3,
             py::arg("eye") = std::array<double, 3>{0, 0, 0}, py::arg("cache") = GeometryCacheSettings{},
             py::arg("motions") = std::map<size_t, Array<double>>())
        .def(py::init(&make_instanced), py::arg("shape").none(false), py::arg("matrices"))
        .def("closest_hits", &closest_hits, py::arg("origins"), py::arg("directions"), py::arg("t_min") = zero,
             py::arg("t_max") = infinity, py::arg("kind") = static_cast<int>(kVisibleAll),
             py::arg("width") = float_number(0.0f), py::arg("spread") = float_number(0.0f),
             py::arg("starts") = Array<uint32_t>(0), py::arg("together") = 1, py::arg("times") = Array<float>(0),
             py::arg("curvature") = true,
             "anchors: instance, subpatch, levels and facet of a hit, which rays that leave it may be given as starts. "
             "The "
             "surface points of so many rays are found together; they are the same. Without curvature normals do not "
             "change.")
        .def("occluded", &occluded, py::arg("origins"), py::arg("directions"), py::arg("t_min") = zero,
             py::arg("t_max") = infinity, py::arg("kind") = static_cast<int>(kVisibleAll),
             py::arg("times") = Array<float>(0))
        .def("timed_closest", &timed, py::arg("origins"), py::arg("directions"), py::arg("width") = float_number(0.0f),
             py::arg("spread") = float_number(0.0f), py::arg("starts") = Array<uint32_t>(0),
             "(processor seconds on one thread, t)")
        .def("bounds", &bounds)
        .def("statistics", &tracer_statistics);

    bind_geometry_cache(module);
    module.def("moved", &moved, py::arg("matrices"), py::arg("time"), "Where a motion is at a time of the shutter.");
    bind_packets(module);
    module.def("simd_targets", &simd_targets, "Instruction sets the kernels can use here, the best one first.");
    module.def("use_simd_target", &choose_simd_target, py::arg("name"), "For new tracers; empty: the best.");
    module.def("diced_patch", &diced_patch, py::arg("surface"), py::arg("patch"));
    module.def("grid_candidates", &grid_candidates, py::arg("surface"), py::arg("patch"), py::arg("origins"),
               py::arg("directions"));
}

}  // namespace rayleaf
