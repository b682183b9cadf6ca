#include "python/arrays.h"
#include "python/ray_arrays.h"
#include "rivals/bindings.h"
#include "rivals/object_set.h"
#include "rivals/rival_paths.h"

namespace rayleaf {
namespace {

py::dict arrays_of(const std::vector<PathAnswer>& answers, double seconds) {
    const size_t count = answers.size();
    py::dict result;
    result["object"] = column<int32_t>(count, 0, [&](size_t i) { return answers[i].object; });
    result["answered_by"] = column<uint8_t>(count, 0, [&](size_t i) { return static_cast<uint8_t>(answers[i].by); });
    result["position"] = column<float>(count, 3, [&](size_t i) { return answers[i].position; });
    result["normal"] = column<float>(count, 3, [&](size_t i) { return answers[i].normal; });
    result["exit_position"] = column<float>(count, 3, [&](size_t i) { return answers[i].exit_position; });
    result["exit_direction"] = column<float>(count, 3, [&](size_t i) { return answers[i].exit_direction; });
    result["length"] = column<float>(count, 0, [&](size_t i) { return answers[i].length; });
    result["seconds"] = seconds;
    return result;
}

/// (shape, kind, index of refraction)
using RivalObject = std::tuple<std::shared_ptr<PatchSurface>, std::string, float>;

std::unique_ptr<RivalTracer> make_tracer(const std::vector<RivalObject>& objects, const std::string& method,
                                         int most_interior_hits) {
    if (method != "TRIANGLES" && method != "NEWTON")
        throw InputError("rival tracer", "method", method, "TRIANGLES or NEWTON");
    std::vector<std::shared_ptr<const PatchSurface>> surfaces;
    std::vector<RivalMaterial> materials;
    for (const auto& [surface, kind, ior] : objects) {
        if (!surface) throw InputError("rival tracer", "objects", "one without a surface", "(surface, kind, ior)");
        surfaces.push_back(surface);
        materials.push_back({named(surface->name(), "kind", kind, kOutputKinds), ior, most_interior_hits});
    }
    return std::make_unique<RivalTracer>(surfaces, std::move(materials),
                                         method == "NEWTON" ? RivalMethod::Newton : RivalMethod::Triangles);
}

py::dict trace(const RivalTracer& tracer, const Array<double>& origins, const Array<double>& directions, bool packets) {
    if (packets && tracer.scene().method() != RivalMethod::Triangles)
        throw InputError("rival tracer", "packets", "true", "false, for all but TRIANGLES");
    const std::vector<Ray> rays = rays_from(origins, directions);
    check_for_embree(rays);
    std::vector<PathAnswer> answers(rays.size());
    const double seconds = timed_blocks(rays, answers, [&](std::span<const Ray> block, size_t, auto out) {
        tracer.trace(block, out, packets ? PacketUse::Packets : PacketUse::SingleRays);
    });
    return arrays_of(answers, seconds);
}

/// A tracer and its scene's counting twin.
struct BoundCounter {
    const RivalTracer* tracer;
    CountingScene twin;
    explicit BoundCounter(const RivalTracer& counted) : tracer(&counted), twin(counted.scene()) {}
};

py::array_t<uint64_t> count(const BoundCounter& counter, const Array<double>& origins,
                            const Array<double>& directions) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    py::array_t<uint64_t> flops(static_cast<py::ssize_t>(rays.size()));
    counter.tracer->count(counter.twin, rays, {flops.mutable_data(), rays.size()});
    return flops;
}

/// An object whose camera rays are answered in the image plane, frame by frame.
struct BoundPlane {
    std::shared_ptr<const SampleTracer> tracer;
    ImagePlaneSettings settings;
    std::unique_ptr<ImagePlane> plane;
};

std::unique_ptr<BoundPlane> make_plane(std::shared_ptr<Shape> shape, const std::string& kind, double ior,
                                       double angle_threshold, double distance_threshold, int most_interior_hits) {
    const SampleSettings samples{named(shape->name(), "kind", kind, kOutputKinds), ior, most_interior_hits};
    auto made = std::make_unique<BoundPlane>();
    made->tracer = std::make_shared<SampleTracer>(std::move(shape), samples);
    made->settings = {angle_threshold, distance_threshold};
    return made;
}

/// A pinhole's frame: the ray through (x, y) goes towards corner + x right + y up.
void look(BoundPlane& bound, const std::array<double, 3>& eye, const std::array<double, 3>& corner,
          const std::array<double, 3>& right, const std::array<double, 3>& up) {
    const auto vector = [](const std::array<double, 3>& v) { return Vec3d(v[0], v[1], v[2]); };
    const auto camera = [e = vector(eye), c = vector(corner), r = vector(right), u = vector(up)](const Vec2d& point) {
        Ray ray;
        ray.origin = e;
        ray.direction = c + r * point.x + u * point.y;
        return ray;
    };
    bound.plane = std::make_unique<ImagePlane>(bound.tracer, camera, bound.settings);
}

py::dict plane_statistics(const BoundPlane& bound) {
    const RayCacheStatistics s = bound.plane ? bound.plane->statistics() : RayCacheStatistics{};
    py::dict result;
    result["samples_taken"] = s.samples_taken;
    result["nodes"] = s.nodes;
    result["leaves"] = s.leaves;
    result["bytes"] = s.bytes;
    return result;
}

/// Keeps what it asks alive.
struct BoundSet {
    py::list parts;
    std::vector<std::unique_ptr<TracedObject>> traced;
    std::unique_ptr<ObjectSet> set;
    std::vector<BoundPlane*> planes;  ///< by member; null for others
    std::vector<SetMember> members;
    SetAnswer wanted = SetAnswer::Nearest;

    /// Planes are made anew each frame.
    ObjectSet& current() {
        if (planes.empty()) return *set;
        for (size_t i = 0; i < members.size(); ++i) {
            if (!planes[i]) continue;
            if (!planes[i]->plane) throw InputError(members[i].shape->name(), "image plane", "no camera", "look()");
            members[i].plane = planes[i]->plane.get();
        }
        set = std::make_unique<ObjectSet>(members, wanted);
        return *set;
    }
};

/// Pairs of a shape and what answers for it.
std::unique_ptr<BoundSet> make_set(const py::list& parts, bool traced, bool sum_of_lengths) {
    auto bound = std::make_unique<BoundSet>();
    bound->parts = parts;
    bound->wanted = sum_of_lengths ? SetAnswer::SumOfLengths : SetAnswer::Nearest;
    bool has_planes = false;
    for (const py::handle& part : parts) {
        const bool is_pair = py::isinstance<py::tuple>(part) && py::len(part) == 2;
        const py::tuple pair = is_pair ? py::reinterpret_borrow<py::tuple>(part) : py::tuple(2);
        if (!is_pair || !py::isinstance<Shape>(pair[0]) ||
            !(py::isinstance<BoundPlane>(pair[1]) || py::isinstance<RayCache>(pair[1])))
            throw InputError("object set", "parts", "one that is no pair", "(shape, RayCache or ImagePlane)");
        SetMember member{pair[0].cast<std::shared_ptr<Shape>>(), nullptr, nullptr};
        BoundPlane* plane = nullptr;
        if (py::isinstance<BoundPlane>(pair[1])) {
            plane = pair[1].cast<BoundPlane*>();
            has_planes = true;
        } else if (traced) {
            bound->traced.push_back(std::make_unique<TracedObject>(*pair[1].cast<RayCache*>()));
            member.cache = bound->traced.back().get();
        } else {
            member.cache = pair[1].cast<RayCache*>();
        }
        bound->members.push_back(member);
        bound->planes.push_back(plane);
    }
    if (!has_planes) bound->planes.clear();
    bound->set = std::make_unique<ObjectSet>(bound->members, bound->wanted);
    return bound;
}

py::dict ask(BoundSet& bound, const Array<double>& origins, const Array<double>& directions,
             const std::optional<Array<float>>& distances, const std::optional<Array<float>>& angles,
             const std::optional<Array<double>>& points, const std::optional<Array<int32_t>>& left) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    const auto count = static_cast<py::ssize_t>(rays.size());
    const std::vector<RaySpacing> spacings = spacings_from(rays.size(), distances, angles);
    std::vector<Vec2d> places;
    if (points) {
        check_shape("rays", "points", *points, {count, 2});
        for (size_t i = 0; i < rays.size(); ++i) places.emplace_back(points->data()[2 * i], points->data()[2 * i + 1]);
    }
    if (places.empty() && !bound.planes.empty() && !rays.empty())
        throw InputError("rays", "points", "none", "one a ray, for image planes");
    if (left) check_shape("rays", "left", *left, {count});
    ObjectSet& set = bound.current();
    std::vector<PathAnswer> answers(rays.size());
    const double seconds = timed_blocks(rays, answers, [&](std::span<const Ray> block, size_t first, auto out) {
        const auto part = [&](auto all) { return all.empty() ? all : all.subspan(first, block.size()); };
        set.ask({block, part(std::span<const RaySpacing>(spacings)), part(std::span<const Vec2d>(places)),
                 part(left ? std::span<const int32_t>(left->data(), rays.size()) : std::span<const int32_t>())},
                out);
    });
    return arrays_of(answers, seconds);
}

}  // namespace

void bind_rivals(py::module_& module) {
    py::class_<RivalTracer>(module, "RivalTracer", "Surfaces as Embree's triangles, or as patches met by Newton.")
        .def(py::init(&make_tracer), py::arg("objects"), py::arg("method"),
             py::arg("most_interior_hits") = kMostInteriorHits,
             "objects: (PatchSurface, kind, ior) each; method: TRIANGLES or NEWTON.")
        .def("trace", &trace, py::arg("origins"), py::arg("directions"), py::arg("packets") = false,
             "Output rays of rays (n, 3) as arrays; processor seconds. Packets: 16 rays at once, through all bounces.")
        .def_property_readonly("bytes", [](const RivalTracer& tracer) { return tracer.scene().bytes(); });
    py::class_<BoundCounter>(module, "FlopCounter", "What a rival's rays take, by a plain tree over the same boxes.")
        .def(py::init<const RivalTracer&>(), py::arg("tracer"), py::keep_alive<1, 2>())
        .def("count", &count, py::arg("origins"), py::arg("directions"), "Floating-point operations of each ray.");
    const ImagePlaneSettings settings;
    py::class_<BoundPlane>(module, "ImagePlane", "One object's camera rays, interpolated between those of the picture.")
        .def(py::init(&make_plane), py::arg("shape").none(false), py::arg("kind"),
             py::arg("ior") = SampleSettings{}.ior, py::arg("angle_threshold") = settings.angle_threshold,
             py::arg("distance_threshold") = settings.distance_threshold,
             py::arg("most_interior_hits") = kMostInteriorHits)
        .def("look", &look, py::arg("eye"), py::arg("corner"), py::arg("right"), py::arg("up"),
             "Begins a frame: the ray through (x, y) goes towards corner + x right + y up.")
        .def("statistics", &plane_statistics);
    py::class_<BoundSet>(module, "ObjectSet", "Several objects of one space, asked as one.")
        .def(py::init(&make_set), py::arg("parts"), py::arg("traced") = false, py::arg("sum_of_lengths") = false,
             "parts: (shape, RayCache or ImagePlane) each; traced: by the caches' own tracers.")
        .def("ask", &ask, py::arg("origins"), py::arg("directions"), py::arg("distances") = py::none(),
             py::arg("angles") = py::none(), py::arg("points") = py::none(), py::arg("left") = py::none(),
             "Output rays of rays (n, 3) as arrays; processor seconds. points (n, 2): in the picture; left (n,): the "
             "object just left, or -1.");
}

}  // namespace rayleaf
