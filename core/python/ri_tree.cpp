#include "python/arrays.h"
#include "python/bindings.h"
#include "ri_tree/reference_tree.h"
#include "trace/baselines.h"

namespace rayleaf {
namespace {

std::vector<Ray> rays_from(const Array<double>& origins, const Array<double>& directions) {
    check_shape("rays", "origins", origins, {-1, 3});
    check_shape("rays", "directions", directions, {-1, 3});
    if (origins.shape(0) != directions.shape(0))
        throw InputError("rays", "directions", shape_text(directions), shape_text(origins));
    std::vector<Ray> rays(static_cast<size_t>(origins.shape(0)));
    for (size_t i = 0; i < rays.size(); ++i) {
        const double *o = origins.data() + 3 * i, *d = directions.data() + 3 * i;
        rays[i].origin = {o[0], o[1], o[2]};
        rays[i].direction = {d[0], d[1], d[2]};
    }
    return rays;
}

/// One array an attribute: `value(i)` of each output, `width` numbers or, for 0, a single one.
template <typename T, typename Value>
py::array_t<T> column(size_t count, size_t width, const Value& value) {
    py::array_t<T> result(width == 0 ? std::vector<size_t>{count} : std::vector<size_t>{count, width});
    T* out = result.mutable_data();
    for (size_t i = 0; i < count; ++i) {
        if constexpr (requires { value(i).x; }) {
            const auto v = value(i);
            for (size_t k = 0; k < width; ++k) out[i * width + k] = static_cast<T>(v[static_cast<int>(k)]);
        } else {
            out[i] = static_cast<T>(value(i));
        }
    }
    return result;
}

/// `output(i)` of `count` rays as arrays.
template <typename Output>
py::dict arrays_of(size_t count, const Output& output) {
    py::dict result;
    const auto path = [&](size_t i) -> const SampleClass& { return output(i).sample_class; };
    result["hit"] = column<bool>(count, 0, [&](size_t i) { return !path(i).is_miss(); });
    result["first_class"] = column<uint32_t>(count, 0, [&](size_t i) { return path(i).first_hit; });
    result["exit_class"] = column<uint32_t>(count, 0, [&](size_t i) { return path(i).exit; });
    result["interior_hits"] = column<uint8_t>(count, 0, [&](size_t i) { return path(i).interior_hits; });
    result["total_reflections"] = column<uint8_t>(count, 0, [&](size_t i) { return path(i).total_reflections; });
    result["ending"] = column<uint8_t>(count, 0, [&](size_t i) { return static_cast<uint8_t>(path(i).ending); });
    result["position"] = column<double>(count, 3, [&](size_t i) { return output(i).position; });
    result["normal"] = column<double>(count, 3, [&](size_t i) { return output(i).normal; });
    result["uv"] = column<double>(count, 2, [&](size_t i) { return output(i).uv; });
    result["exit_position"] = column<double>(count, 3, [&](size_t i) { return output(i).exit_position; });
    result["exit_direction"] = column<double>(count, 3, [&](size_t i) { return output(i).exit_direction; });
    result["length"] = column<double>(count, 0, [&](size_t i) { return output(i).length; });
    return result;
}

std::unique_ptr<ReferenceTree> make_tree(std::shared_ptr<Shape> shape, const std::string& kind, double ior,
                                         double distance_threshold, double angle_threshold, int depth_limit,
                                         uint64_t cache_bytes, double pruned_share, double facet_tolerance) {
    SampleSettings samples;
    if (kind == "SIMPLE")
        samples.kind = OutputKind::Simple;
    else if (kind == "MIRROR")
        samples.kind = OutputKind::Mirror;
    else if (kind == "GLASS")
        samples.kind = OutputKind::Glass;
    else if (kind == "VOLUME")
        samples.kind = OutputKind::Volume;
    else
        throw InputError(shape->name(), "kind", kind, "SIMPLE, MIRROR, GLASS or VOLUME");
    samples.ior = ior;
    samples.facet_tolerance = facet_tolerance;
    return std::make_unique<ReferenceTree>(
        std::move(shape), samples,
        RayCacheSettings{distance_threshold, angle_threshold, depth_limit, cache_bytes, pruned_share});
}

py::dict ask(ReferenceTree& tree, const Array<double>& origins, const Array<double>& directions) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    std::vector<CachedAnswer> answers(rays.size());
    const double begin = thread_seconds();
    tree.ask(rays, {}, answers);
    const double seconds = thread_seconds() - begin;
    py::dict result = arrays_of(answers.size(), [&](size_t i) -> const OutputRay& { return answers[i].output; });
    result["answered_by"] =
        column<uint8_t>(answers.size(), 0, [&](size_t i) { return static_cast<uint8_t>(answers[i].by); });
    result["error"] = column<double>(answers.size(), 0, [&](size_t i) { return answers[i].error; });
    result["seconds"] = seconds;
    return result;
}

py::dict trace_alone(const ReferenceTree& tree, const Array<double>& origins, const Array<double>& directions) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    std::vector<OutputRay> outputs(rays.size());
    const double begin = thread_seconds();
    for (size_t i = 0; i < rays.size(); ++i) outputs[i] = tree.trace(rays[i]);
    const double seconds = thread_seconds() - begin;
    py::dict result = arrays_of(outputs.size(), [&](size_t i) -> const OutputRay& { return outputs[i]; });
    result["seconds"] = seconds;
    return result;
}

using KeyTuple = std::tuple<int, int, std::array<uint32_t, kLineAxes>>;

CellKey key_from(const KeyTuple& tuple) {
    const auto& [direction, depth, index] = tuple;
    if (direction < 0 || direction >= kLineDirections || depth < 0 || depth > kGreatestCellDepth)
        throw py::value_error("a cell is (direction 0 to 5, depth 0 to 60, four indices)");
    return {static_cast<uint8_t>(direction), static_cast<uint8_t>(depth), index};
}

py::tuple pair_of(const std::vector<Ray>& rays) {
    return py::make_tuple(column<double>(rays.size(), 3, [&](size_t i) { return rays[i].origin; }),
                          column<double>(rays.size(), 3, [&](size_t i) { return rays[i].direction; }));
}

py::tuple corner_rays(const ReferenceTree& tree, const KeyTuple& cell) {
    const CellKey key = key_from(cell);
    std::vector<Ray> rays(kCellCorners);
    for (int corner = 0; corner < kCellCorners; ++corner) rays[corner] = tree.space().corner_ray(key, corner);
    return pair_of(rays);
}

py::tuple center_ray(const ReferenceTree& tree, const KeyTuple& cell) {
    return pair_of({tree.space().center_ray(key_from(cell))});
}

std::array<int, kLineAxes> levels(const ReferenceTree& tree, int direction, int depth) {
    const CellKey key = key_from({direction, depth, {}});
    std::array<int, kLineAxes> result{};
    for (int i = 0; i < kLineAxes; ++i) result[i] = tree.space().levels(key.direction, key.depth)[i];
    return result;
}

py::tuple box(const ReferenceTree& tree) {
    const Box3d& b = tree.space().box();
    return py::make_tuple(std::array{b.min.x, b.min.y, b.min.z}, std::array{b.max.x, b.max.y, b.max.z});
}

py::list final_cells(ReferenceTree& tree, const Array<double>& origins, const Array<double>& directions) {
    py::list result;
    for (const Ray& ray : rays_from(origins, directions)) {
        const std::optional<CellKey> key = tree.final_cell(ray);
        if (key)
            result.append(py::make_tuple(int{key->direction}, int{key->depth}, key->index));
        else
            result.append(py::none());
    }
    return result;
}

py::tuple lines(const ReferenceTree& tree, const Array<double>& origins, const Array<double>& directions) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    std::vector<Line> made;
    made.reserve(rays.size());
    for (const Ray& ray : rays) made.push_back(tree.space().line(ray.origin, ray.direction));
    return py::make_tuple(column<int32_t>(made.size(), 0, [&](size_t i) { return made[i].direction; }),
                          column<double>(made.size(), kLineAxes, [&](size_t i) {
                              const auto& s = made[i].shares;
                              return Vec4d(s[0], s[1], s[2], s[3]);
                          }));
}

py::dict statistics(const ReferenceTree& tree) {
    const RayCacheStatistics s = tree.statistics();
    py::dict answers;
    for (size_t i = 0; i < kAnswerKinds; ++i) answers[answer_names()[i]] = s.answers[i];
    py::dict result;
    result["answers"] = answers;
    result["samples_taken"] = s.samples_taken;
    result["samples"] = s.samples;
    result["nodes"] = s.nodes;
    result["leaves"] = s.leaves;
    result["bytes"] = s.bytes;
    result["most_bytes"] = s.most_bytes;
    result["prunes"] = s.prunes;
    return result;
}

}  // namespace

void bind_ri_tree(py::module_& parent) {
    py::module_ module = parent.def_submodule("ri_tree", "Ray caches over one shape, for tests and benchmarks.");
    module.attr("ANSWERS") = py::cast(std::vector<std::string>(answer_names().begin(), answer_names().end()));
    const SampleSettings samples;
    const RayCacheSettings settings;
    py::class_<ReferenceTree>(module, "ReferenceTree", "The ray interpolant tree as published. One thread at a time.")
        .def(py::init(&make_tree), py::arg("shape"), py::arg("kind"), py::arg("ior") = samples.ior,
             py::arg("distance_threshold") = settings.distance_threshold,
             py::arg("angle_threshold") = settings.angle_threshold, py::arg("depth_limit") = settings.depth_limit,
             py::arg("cache_bytes") = settings.cache_bytes, py::arg("pruned_share") = settings.pruned_share,
             py::arg("facet_tolerance") = samples.facet_tolerance,
             "kind: SIMPLE, MIRROR, GLASS or VOLUME. Thresholds: a share of the box's half extent, and radians.")
        .def("ask", &ask, py::arg("origins"), py::arg("directions"),
             "Outputs of rays (n, 3) in object space as arrays; answered_by indexes ANSWERS; processor seconds.")
        .def("trace", &trace_alone, py::arg("origins"), py::arg("directions"), "The same by tracing alone.")
        .def("final_cells", &final_cells, py::arg("origins"), py::arg("directions"),
             "(direction, depth, indices) of the cells that answer, None for rays that miss the box.")
        .def("corner_rays", &corner_rays, py::arg("cell"), "Origins and directions (16, 3), local space.")
        .def("center_ray", &center_ray, py::arg("cell"), "Origin and direction (1, 3), local space.")
        .def("levels", &levels, py::arg("direction"), py::arg("depth"), "How often each axis of a cell was halved.")
        .def("box", &box, "Lowest and highest corner of the widened box, local space.")
        .def("lines", &lines, py::arg("origins"), py::arg("directions"),
             "Direction and shares (n, 4) of the lines of rays in local space.")
        .def_property_readonly("class_count", [](const ReferenceTree& tree) { return tree.tracer().classes().count(); })
        .def("statistics", &statistics);
}

}  // namespace rayleaf
