// Triangle meshes with any arrays: lengths that do not fit, indices out of range, vertices that are no numbers.
#include "fuzz_shapes.h"
#include "geometry/triangle_mesh.h"

using namespace rayleaf;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    const int vertices = bytes.count(12), triangles = bytes.count(12);
    const std::vector<float> places = bytes.ill_fitting_floats(3 * static_cast<size_t>(vertices));
    const std::vector<int32_t> corners = bytes.ill_fitting_indices(3 * static_cast<size_t>(triangles), vertices);
    const std::vector<float> normals =
        bytes.flag() ? bytes.ill_fitting_floats(9 * static_cast<size_t>(triangles)) : std::vector<float>();
    const std::vector<int32_t> slots = bytes.slots(static_cast<size_t>(triangles));
    fuzz::refusing([&] {
        TriangleMeshArrays arrays;
        arrays.name = "drawn";
        arrays.vertices = places;
        arrays.triangles = corners;
        arrays.corner_normals = normals;
        arrays.material_slots = slots;
        if (bytes.flag()) {
            const int channels = bytes.count(5);
            arrays.active_uv = bytes.count(1);
            arrays.attributes.push_back(
                {0, channels, bytes.ill_fitting_floats(static_cast<size_t>(3 * triangles * channels))});
        }
        fuzz::trace_drawn_rays(std::make_shared<TriangleMesh>(std::move(arrays)), bytes);
    });
    return 0;
}
