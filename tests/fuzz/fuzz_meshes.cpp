// Triangle meshes with any arrays: lengths that do not fit, indices out of range, vertices that are no numbers.
#include "fuzz_shapes.h"
#include "geometry/triangle_mesh.h"

using namespace rayleaf;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    const int vertices = bytes.count(12), triangles = bytes.count(12);
    const std::vector<float> places = bytes.floats(3 * static_cast<size_t>(vertices) + bytes.odd_length());
    const std::vector<int32_t> corners =
        bytes.indices(3 * static_cast<size_t>(triangles) + bytes.odd_length(), vertices);
    const std::vector<float> normals =
        bytes.flag() ? bytes.floats(9 * static_cast<size_t>(triangles) + bytes.odd_length()) : std::vector<float>();
    const std::vector<int32_t> slots =
        bytes.flag() ? bytes.indices(static_cast<size_t>(triangles) + bytes.odd_length(), 4) : std::vector<int32_t>();
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
                {0, channels, bytes.floats(static_cast<size_t>(3 * triangles * channels) + bytes.odd_length())});
        }
        fuzz::trace_drawn_rays(std::make_shared<TriangleMesh>(std::move(arrays)), bytes);
    });
    return 0;
}
