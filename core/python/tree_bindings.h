// The bindings that every ray cache of cells has.
#pragma once

#include "python/bindings.h"
#include "python/ray_arrays.h"
#include "ri_tree/line_space.h"

namespace rayleaf {

template <typename Tree>
std::unique_ptr<Tree> make_tree(std::shared_ptr<Shape> shape, const std::string& kind, double ior,
                                double distance_threshold, double angle_threshold, int depth_limit,
                                uint64_t cache_bytes, double pruned_share, double facet_tolerance,
                                double direction_threshold, int mixed_depth_limit, int most_interior_hits,
                                double rays_per_cell) {
    const SampleSettings samples{named(shape->name(), "kind", kind, kOutputKinds), ior, most_interior_hits,
                                 facet_tolerance};
    return std::make_unique<Tree>(
        std::move(shape), samples,
        RayCacheSettings{distance_threshold, angle_threshold, depth_limit, cache_bytes, pruned_share,
                         direction_threshold, mixed_depth_limit, rays_per_cell});
}

using KeyTuple = std::tuple<int, int, std::array<uint32_t, kLineAxes>>;

inline CellKey key_from(const KeyTuple& tuple) {
    const auto& [direction, depth, index] = tuple;
    if (direction < 0 || direction >= kLineDirections || depth < 0 || depth > kGreatestCellDepth)
        throw py::value_error("a cell is (direction 0 to 5, depth 0 to 60, four indices)");
    return {static_cast<uint8_t>(direction), static_cast<uint8_t>(depth), index};
}

inline py::tuple pair_of(const std::vector<Ray>& rays) {
    return py::make_tuple(column<double>(rays.size(), 3, [&](size_t i) { return rays[i].origin; }),
                          column<double>(rays.size(), 3, [&](size_t i) { return rays[i].direction; }));
}

template <typename Tree>
py::tuple corner_rays(const Tree& tree, const KeyTuple& cell) {
    const CellKey key = key_from(cell);
    std::vector<Ray> rays(kCellCorners);
    for (int corner = 0; corner < kCellCorners; ++corner) rays[corner] = tree.space().corner_ray(key, corner);
    return pair_of(rays);
}

template <typename Tree>
py::tuple center_ray(const Tree& tree, const KeyTuple& cell) {
    return pair_of({tree.space().center_ray(key_from(cell))});
}

template <typename Tree>
std::array<int, kLineAxes> levels(const Tree& tree, int direction, int depth) {
    const CellKey key = key_from({direction, depth, {}});
    std::array<int, kLineAxes> result{};
    for (int i = 0; i < kLineAxes; ++i) result[i] = tree.space().levels(key.direction, key.depth)[i];
    return result;
}

template <typename Tree>
py::tuple box(const Tree& tree) {
    const Box3d& b = tree.space().box();
    return py::make_tuple(std::array{b.min.x, b.min.y, b.min.z}, std::array{b.max.x, b.max.y, b.max.z});
}

template <typename Tree>
py::list final_cells(Tree& tree, const Array<double>& origins, const Array<double>& directions) {
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

template <typename Tree>
py::tuple lines(const Tree& tree, const Array<double>& origins, const Array<double>& directions) {
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

template <typename Tree>
py::class_<Tree, RayCache> bind_tree(py::module_& module, const char* name, const char* description) {
    const SampleSettings samples;
    const RayCacheSettings settings;
    py::class_<Tree, RayCache> tree_class(module, name, description);
    tree_class
        .def(py::init(&make_tree<Tree>), py::arg("shape").none(false), py::arg("kind"), py::arg("ior") = samples.ior,
             py::arg("distance_threshold") = settings.distance_threshold,
             py::arg("angle_threshold") = settings.angle_threshold, py::arg("depth_limit") = settings.depth_limit,
             py::arg("cache_bytes") = settings.cache_bytes, py::arg("pruned_share") = settings.pruned_share,
             py::arg("facet_tolerance") = samples.facet_tolerance,
             py::arg("direction_threshold") = settings.direction_threshold,
             py::arg("mixed_depth_limit") = settings.mixed_depth_limit,
             py::arg("most_interior_hits") = samples.most_interior_hits,
             py::arg("rays_per_cell") = settings.rays_per_cell,
             "kind: SIMPLE, MIRROR, GLASS or VOLUME. Thresholds: a share of the box's half extent, and radians. Paths "
             "in glass of more than most_interior_hits hits from inside are cut off.")
        .def("final_cells", &final_cells<Tree>, py::arg("origins"), py::arg("directions"),
             "(direction, depth, indices) of the cells that answer, None for rays that miss the box.")
        .def("corner_rays", &corner_rays<Tree>, py::arg("cell"), "Origins and directions (16, 3), local space.")
        .def("center_ray", &center_ray<Tree>, py::arg("cell"), "Origin and direction (1, 3), local space.")
        .def("levels", &levels<Tree>, py::arg("direction"), py::arg("depth"),
             "How often each axis of a cell was halved.")
        .def("box", &box<Tree>, "Lowest and highest corner of the widened box, local space.")
        .def("lines", &lines<Tree>, py::arg("origins"), py::arg("directions"),
             "Direction and shares (n, 4) of the lines of rays in local space.")
        .def_property_readonly("class_count", [](const Tree& tree) { return tree.tracer().classes().count(); });
    return tree_class;
}

}  // namespace rayleaf
