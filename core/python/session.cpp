#include "render/session.h"

#include "base/error.h"
#include "python/bindings.h"
#include "python/film.h"
#include "python/geometry_cache.h"

namespace rayleaf {
namespace {

const char* state_name(RenderState state) {
    switch (state) {
        case RenderState::Waiting:
            return "waiting";
        case RenderState::Building:
            return "building";
        case RenderState::Rendering:
            return "rendering";
        case RenderState::Done:
            return "done";
        case RenderState::Cancelled:
            break;
    }
    return "cancelled";
}

py::array_t<float> session_pixels(const Session& session, const std::string& name) {
    const std::optional<Pass> pass = find_pass(name);
    std::vector<float> pixels = pass ? session.film().pixels(*pass) : std::vector<float>();
    if (pixels.empty()) throw InputError("session", "pass", "'" + name + "'", "one of the passes in the settings");
    return array_of(std::move(pixels), session.film().width(), session.film().height(), *pass);
}

py::dict sums(const Session& session) {
    if (!session.sums()) throw InputError("session", "sums", "not kept", "settings with keep_sums");
    py::dict result;
    for (const Pass pass : session.sums()->summed_passes())
        result[py::str(std::string(info(pass).identifier))] = sums_of(*session.sums(), pass);
    add_mattes(*session.sums(), result);
    return result;
}

/// Bytes of the shapes of each kind that the scene has.
py::dict shape_bytes(const ShapeShares& shares) {
    py::dict result;
    for (size_t kind = 0; kind < kShapeKinds; ++kind)
        if (shares[kind].shapes > 0) result[shape_kind_name(static_cast<ShapeKind>(kind))] = shares[kind].bytes;
    return result;
}

/// Hits where a patch has no normal of its own, by what answered instead.
py::dict limit_normals(const NormalCounters& counters) {
    constexpr std::pair<NormalStage, const char*> kStages[] = {{NormalStage::SecondOrder, "second_order"},
                                                               {NormalStage::Inset, "inset"},
                                                               {NormalStage::Neighbour, "neighbour"},
                                                               {NormalStage::Geometric, "geometric"}};
    py::dict result;
    for (const auto& [stage, name] : kStages) result[name] = counters.counts[static_cast<size_t>(stage)];
    return result;
}

py::dict rays(const RenderStatistics& s) {
    using namespace py::literals;
    py::dict result("pixels"_a = s.pixels, "paths"_a = s.paths);
    for (size_t use = 0; use < kRayUseNames.size(); ++use)
        if (s.rays.of[use] > 0) result[kRayUseNames[use]] = s.rays.of[use];
    if (s.rays.catcher_paths > 0) result["catcher_paths"] = s.rays.catcher_paths;
    return result;
}

/// Hemispheres of diffuse surfaces: those kept in the cache, and how those of the frame were answered.
py::dict hemispheres(const RenderStatistics& s) {
    using namespace py::literals;
    return py::dict("sampled"_a = s.rays.hemispheres_sampled, "interpolated"_a = s.rays.hemispheres_interpolated,
                    "records"_a = s.irradiance_records, "fill_seconds"_a = s.irradiance_seconds);
}

const char* kind_name(OutputKind kind) {
    constexpr const char* kNames[] = {"simple", "mirror", "glass", "volume"};
    return kNames[static_cast<size_t>(kind)];
}

/// One entry a cache, and one for objects that can have none.
py::list ray_caches(const RenderStatistics& statistics) {
    using namespace py::literals;
    py::list list;
    for (const RayCacheReport& report : statistics.ray_caches) {
        const RayCacheStatistics& s = report.statistics;
        py::dict answers;
        for (size_t i = 0; i < kAnswerKinds; ++i) answers[answer_names()[i]] = s.answers[i];
        const RayCacheTotals totals = totals_of(s);
        list.append(py::dict(
            "objects"_a = report.objects, "instances"_a = report.instances, "kind"_a = kind_name(report.kind),
            "mode"_a = report.mode == RayInterpolationMode::Auto ? "AUTO" : "ON", "used"_a = report.used,
            "reason"_a = report.reason, "queries"_a = totals.queries, "interpolated"_a = totals.interpolated,
            "followed"_a = totals.followed, "traced"_a = totals.traced, "missed"_a = totals.missed,
            "answers"_a = answers, "samples_taken"_a = s.samples_taken, "samples"_a = s.samples, "nodes"_a = s.nodes,
            "leaves"_a = s.leaves, "bytes"_a = s.bytes, "tracer_bytes"_a = s.tracer_bytes, "prunes"_a = s.prunes));
    }
    return list;
}

/// Bevelled curves and hair, where there are any.
py::dict curves(const RenderStatistics& s) {
    using namespace py::literals;
    const CurveStatistics& c = s.curves;
    const ShapeShare &swept = s.shapes_of[static_cast<size_t>(ShapeKind::SweptSurface)],
                     &hair = s.shapes_of[static_cast<size_t>(ShapeKind::Strands)];
    py::dict result;
    if (swept.shapes > 0)
        result["swept"] = py::dict("surfaces"_a = swept.shapes, "splines"_a = c.splines, "pieces"_a = c.pieces,
                                   "bytes"_a = swept.bytes);
    if (hair.shapes > 0)
        result["hair"] = py::dict("objects"_a = hair.shapes, "strands"_a = c.strands, "segments"_a = c.segments,
                                  "bytes"_a = hair.bytes);
    return result;
}

/// Where a target is set: how near the noise has come.
py::dict error(const RenderStatistics& s) {
    using namespace py::literals;
    if (!(s.target_error > 0.0)) return {};
    return py::dict("target"_a = s.target_error, "noise"_a = s.estimated_error);
}

py::dict session_statistics(const Session& session) {
    using namespace py::literals;
    const RenderStatistics s = session.statistics();
    const TraceStatistics& t = s.trace;
    return py::dict(
        "time"_a = py::dict("build_seconds"_a = s.build_seconds, "render_seconds"_a = s.render_seconds),
        "rays"_a = rays(s), "hemispheres"_a = hemispheres(s),
        "geometry"_a = py::dict("shapes"_a = t.shapes, "instances"_a = t.instances, "triangles"_a = t.triangles,
                                "subpatches"_a = t.subpatches, "opened_instances"_a = t.opened_instances,
                                "kept_shapes"_a = t.kept_shapes, "resident_shapes"_a = t.resident_shapes,
                                "limit_normals"_a = limit_normals(t.limit_normals)),
        "curves"_a = curves(s), "geometry_cache"_a = geometry_cache_statistics(t.geometry), "error"_a = error(s),
        "lights"_a = s.lights, "ray_caches"_a = ray_caches(s),
        "memory"_a =
            py::dict("shapes"_a = s.shape_bytes, "facets"_a = t.facet_bytes, "grids"_a = t.geometry.bytes,
                     "subpatches"_a = t.record_bytes, "acceleration"_a = t.bvh_bytes, "lights"_a = s.light_bytes,
                     "film"_a = s.film_bytes, "irradiance"_a = s.irradiance_bytes, "textures"_a = s.textures.bytes),
        "shape_bytes"_a = shape_bytes(s.shapes_of), "left_out"_a = left_out(s, session.film()));
}

int checked_blocks(int size) {
    if (size < 1) throw InputError("session", "size of blocks", std::to_string(size), "at least 1");
    return size;
}

int checked_samples(int count) {
    constexpr int kMost = 1 << 20;
    if (count < 1 || count > kMost)
        throw InputError("session", "number of samples", std::to_string(count), "1 to " + std::to_string(kMost));
    return count;
}

}  // namespace

void bind_session(py::module_& module) {
    using namespace py::literals;
    py::class_<Session, std::shared_ptr<Session>>(module, "Session",
                                                  "One render of one scene. Commits the scene in `render`, not before.")
        .def(py::init([](const std::shared_ptr<SceneDescription>& scene, const Settings& settings,
                         const std::shared_ptr<RayCacheStore>& ray_caches) {
                 return std::make_shared<Session>(scene, settings, ray_caches);
             }),
             py::arg("scene").none(false), "settings"_a, "ray_caches"_a = py::none())
        .def("render",
             [](Session& session) {
                 session.take_scene();  // all that adds to a scene holds the interpreter's lock, as this does
                 const py::gil_scoped_release released;
                 return session.render();
             })
        .def("build",
             [](Session& session) {
                 session.take_scene();
                 const py::gil_scoped_release released;
                 return session.build();
             })
        .def(
            "render_blocks", [](Session& session, int size) { return session.render_blocks(checked_blocks(size)); },
            "size"_a, py::call_guard<py::gil_scoped_release>())
        .def(
            "render_more", [](Session& session, int count) { return session.render_more(checked_samples(count)); },
            "count"_a, py::call_guard<py::gil_scoped_release>())
        .def("cancel", &Session::cancel)
        .def("progress",
             [](const Session& session) {
                 const Progress progress = session.progress();
                 return std::make_pair(std::string(state_name(progress.state)), progress.share);
             })
        .def("pass_pixels", &session_pixels, "name"_a)
        .def("statistics", &session_statistics)
        .def("sums", &sums)
        .def(
            "write_exr", [](const Session& session, const std::string& path) { session.write_exr(path); }, "path"_a,
            py::call_guard<py::gil_scoped_release>())
        .def(
            "write_ppm", [](const Session& session, const std::string& path) { write_ppm(session.film(), path); },
            "path"_a, py::call_guard<py::gil_scoped_release>());
}

}  // namespace rayleaf
