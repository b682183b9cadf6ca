#include "python/arrays.h"
#include "python/bindings.h"
#include "python/tree_bindings.h"
#include "ri_tree/fast_tree.h"

namespace rayleaf {
namespace {

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

py::dict ask(RayCache& cache, const Array<double>& origins, const Array<double>& directions,
             const std::optional<Array<float>>& distances, const std::optional<Array<float>>& angles) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    const std::vector<RaySpacing> spacings = spacings_from(rays.size(), distances, angles);
    std::vector<CachedAnswer> answers(rays.size());
    const double seconds = timed_blocks(rays, answers, [&](std::span<const Ray> block, size_t first, auto out) {
        const std::span<const RaySpacing> all(spacings);
        cache.ask(block, all.empty() ? all : all.subspan(first, block.size()), out);
    });
    py::dict result = arrays_of(answers.size(), [&](size_t i) -> const OutputRay& { return answers[i].output; });
    result["answered_by"] =
        column<uint8_t>(answers.size(), 0, [&](size_t i) { return static_cast<uint8_t>(answers[i].by); });
    result["error"] = column<double>(answers.size(), 0, [&](size_t i) { return answers[i].error; });
    result["seconds"] = seconds;
    return result;
}

py::dict trace_alone(const RayCache& cache, const Array<double>& origins, const Array<double>& directions) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    std::vector<OutputRay> outputs(rays.size());
    const double seconds = timed_blocks(rays, outputs, [&](std::span<const Ray> block, size_t, auto out) {
        for (size_t i = 0; i < block.size(); ++i) out[i] = cache.trace(block[i]);
    });
    py::dict result = arrays_of(outputs.size(), [&](size_t i) -> const OutputRay& { return outputs[i]; });
    result["seconds"] = seconds;
    return result;
}

py::dict ray_cache_statistics(const RayCache& tree) {
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
    result["tracer_bytes"] = s.tracer_bytes;
    return result;
}

/// Samples at lattice points of one dominant direction.
py::dict samples(const FastTree& tree, int direction, const Array<uint32_t>& places) {
    const CellKey key = key_from({direction, 0, {}});
    check_shape("samples", "places", places, {-1, kLineAxes});
    std::vector<FastSample> taken(static_cast<size_t>(places.shape(0)));
    std::vector<OutputRay> paths(taken.size());
    for (size_t i = 0; i < taken.size(); ++i) {
        LatticePoint point{key.direction, {}};
        std::copy_n(places.data() + i * kLineAxes, kLineAxes, point.place.begin());
        taken[i] = tree.sample(point);
        paths[i].sample_class = taken[i].sample_class;
    }
    py::dict result = arrays_of(paths.size(), [&](size_t i) -> const OutputRay& { return paths[i]; });
    const auto count = static_cast<size_t>(sample_value_count(tree.tracer().settings().kind));
    py::array_t<float> values({taken.size(), count}), changes({taken.size(), count, size_t{kLineAxes}});
    for (size_t i = 0; i < taken.size(); ++i) {
        std::copy_n(taken[i].values.data(), count, values.mutable_data() + i * count);
        std::copy_n(taken[i].changes.front().data(), count * kLineAxes, changes.mutable_data() + i * count * kLineAxes);
    }
    result["values"] = values;
    result["changes"] = changes;
    return result;
}

/// How interpolated answers change with steps (n, 2, 3) of origins and directions.
py::dict changes(FastTree& tree, const Array<double>& origins, const Array<double>& directions,
                 const Array<float>& origin_steps, const Array<float>& direction_steps) {
    const std::vector<Ray> rays = rays_from(origins, directions);
    const auto count = static_cast<py::ssize_t>(rays.size());
    check_shape("changes", "origin_steps", origin_steps, {count, 2, 3});
    check_shape("changes", "direction_steps", direction_steps, {count, 2, 3});
    std::vector<RayDifferential> differentials(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        const auto step = [i](const Array<float>& all, size_t which) {
            const float* v = all.data() + (2 * i + which) * 3;
            return Vec3f(v[0], v[1], v[2]);
        };
        differentials[i] = {step(origin_steps, 0), step(origin_steps, 1), step(direction_steps, 0),
                            step(direction_steps, 1)};
    }
    std::vector<CachedAnswer> answers(rays.size());
    std::vector<HitChanges> found(rays.size());
    tree.ask({rays, {}, Uninterpolated::Leave, differentials}, answers, found);
    py::dict result;
    result["known"] = column<bool>(rays.size(), 0, [&](size_t i) { return found[i].are_known; });
    const auto steps = [&](Vec3f HitChanges::Step::*member) {
        return column<double>(2 * rays.size(), 3, [&](size_t i) { return Vec3d(found[i / 2].steps[i % 2].*member); })
            .reshape({count, py::ssize_t{2}, py::ssize_t{3}});
    };
    result["normal"] = steps(&HitChanges::Step::normal);
    result["exit_position"] = steps(&HitChanges::Step::exit_position);
    result["exit_direction"] = steps(&HitChanges::Step::exit_direction);
    return result;
}

}  // namespace

void bind_ri_tree(py::module_& parent) {
    py::module_ module = parent.def_submodule("ri_tree", "Ray caches over one shape, for tests and benchmarks.");
    module.attr("ANSWERS") = py::cast(std::vector<std::string>(answer_names().begin(), answer_names().end()));
    module.def(
        "quality_settings",
        [](double error) {
            const RayCacheSettings s = quality_settings(error);
            py::dict result;
            result["distance_threshold"] = s.distance_threshold;
            result["direction_threshold"] = s.direction_threshold;
            result["angle_threshold"] = s.angle_threshold;
            result["depth_limit"] = s.depth_limit;
            result["mixed_depth_limit"] = s.mixed_depth_limit;
            result["rays_per_cell"] = s.rays_per_cell;
            return result;
        },
        py::arg("error"), "The thresholds that keep the mean error of RGB values near `error`, as a tree's arguments.");
    py::class_<RayCache>(module, "RayCache", "What is asked with rays against one shape.")
        .def("ask", &ask, py::arg("origins"), py::arg("directions"), py::arg("distances") = py::none(),
             py::arg("angles") = py::none(),
             "Outputs of rays (n, 3) in object space as arrays; answered_by indexes ANSWERS; processor seconds. "
             "distances and angles (n,): the rays' spacing. Other threads may run meanwhile.")
        .def("trace", &trace_alone, py::arg("origins"), py::arg("directions"), "The same by tracing alone.")
        .def("next_frame", &RayCache::next_frame)
        .def("statistics", &ray_cache_statistics);
    bind_tree<FastTree>(module, "FastTree", "The ray cache that renders. Any number of threads.")
        .def("changes", &changes, py::arg("origins"), py::arg("directions"), py::arg("origin_steps"),
             py::arg("direction_steps"),
             "How interpolated answers change with two steps of each ray, arrays (n, 2, 3): known, normal, "
             "exit_position, exit_direction.")
        .def("samples", &samples, py::arg("direction"), py::arg("places"),
             "Samples at lattice points (n, 4), shares times 2^31: values (n, k), changes by the line's coordinates as "
             "shares of the root cell's half sides (n, k, 4), and what happened on the way.");
}

}  // namespace rayleaf
