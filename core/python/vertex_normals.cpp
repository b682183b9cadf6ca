#include "geometry/vertex_normals.h"

#include "python/arrays.h"

#include <algorithm>
#include <numeric>

namespace rayleaf {
namespace {

const char* const kOwner = "vertex_normals";

py::array_t<float> normals(const Array<float>& vertices, const Array<int32_t>& face_sizes,
                           const Array<int32_t>& corners) {
    check_shape(kOwner, "vertices", vertices, {-1, 3});
    check_shape(kOwner, "face_sizes", face_sizes, {-1});
    check_shape(kOwner, "corners", corners, {-1});
    std::vector<Vec3f> places(static_cast<size_t>(vertices.shape(0)));
    for (size_t i = 0; i < places.size(); ++i)
        places[i] = {vertices.data()[3 * i], vertices.data()[3 * i + 1], vertices.data()[3 * i + 2]};
    const std::span<const int32_t> sizes(face_sizes.data(), static_cast<size_t>(face_sizes.size()));
    const std::span<const int32_t> all(corners.data(), static_cast<size_t>(corners.size()));
    const bool are_counts = std::ranges::all_of(sizes, [](int32_t size) { return size >= 0; });
    if (!are_counts || std::accumulate(sizes.begin(), sizes.end(), int64_t{0}) != static_cast<int64_t>(all.size()))
        throw InputError(kOwner, "face_sizes", "other numbers",
                         "as many as there are corners, " + std::to_string(all.size()) + " in all");
    const auto last = static_cast<int64_t>(places.size()) - 1;
    for (const int32_t corner : all)
        if (corner < 0 || corner > last)
            throw InputError(kOwner, "corners", std::to_string(corner), "0 to " + std::to_string(last));
    std::vector<Vec3f> found;
    {
        const py::gil_scoped_release released;
        found = vertex_normals(places, sizes, all);
    }
    py::array_t<float> result(std::vector<py::ssize_t>{vertices.shape(0), 3});
    float* out = result.mutable_data();
    for (const Vec3f& normal : found)
        for (int axis = 0; axis < 3; ++axis) *out++ = normal[axis];
    return result;
}

}  // namespace

void bind_vertex_normals(py::module_& module) {
    using namespace py::literals;
    module.def("vertex_normals", &normals, "vertices"_a, "face_sizes"_a, "corners"_a);
}

}  // namespace rayleaf
