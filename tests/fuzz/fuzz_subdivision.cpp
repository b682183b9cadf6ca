// Subdivision cages of any faces, creases and maps: refused with a message, or traced without harm.
#include "fuzz_shapes.h"
#include "geometry/subdivision_surface.h"

using namespace rayleaf;

namespace {

/// A cage's arrays; the cage itself only points at them.
struct Drawn {
    std::vector<float> vertices, crease_sharpness, vertex_sharpness;
    std::vector<int32_t> face_sizes, corners, crease_edges, crease_vertices, material_slots;
    std::vector<CornerAttribute> uv_maps, attributes;

    explicit Drawn(fuzz::Bytes& bytes);
    CornerAttribute map(fuzz::Bytes& bytes, int channels) const;
};

CornerAttribute Drawn::map(fuzz::Bytes& bytes, int channels) const {
    return {bytes.count(2), channels, bytes.ill_fitting_floats(corners.size() * static_cast<size_t>(channels))};
}

Drawn::Drawn(fuzz::Bytes& bytes) {
    const int count = bytes.count(10);
    vertices = bytes.ill_fitting_floats(3 * static_cast<size_t>(count));
    size_t corner_count = bytes.odd_length();
    for (int i = bytes.count(6); i > 0; --i) {
        face_sizes.push_back(bytes.odd_length() != 0 ? static_cast<int8_t>(bytes.byte()) : 3 + bytes.count(3));
        corner_count += static_cast<size_t>(std::max(face_sizes.back(), 0));
    }
    corners = bytes.indices(corner_count, count);
    const auto creases = static_cast<size_t>(bytes.count(4)), sharp = static_cast<size_t>(bytes.count(3));
    crease_edges = bytes.ill_fitting_indices(2 * creases, count);
    crease_sharpness = bytes.ill_fitting_floats(creases);
    crease_vertices = bytes.indices(sharp, count);
    vertex_sharpness = bytes.ill_fitting_floats(sharp);
    material_slots = bytes.slots(face_sizes.size());
    if (bytes.flag()) uv_maps.push_back(map(bytes, bytes.odd_length() != 0 ? bytes.count(5) : 2));
    if (bytes.flag()) attributes.push_back(map(bytes, bytes.count(5)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    const Drawn drawn(bytes);
    fuzz::refusing([&] {
        SubdivisionCage cage;
        cage.name = "drawn";
        cage.vertices = drawn.vertices;
        cage.face_sizes = drawn.face_sizes;
        cage.corners = drawn.corners;
        cage.crease_edges = drawn.crease_edges;
        cage.crease_sharpness = drawn.crease_sharpness;
        cage.crease_vertices = drawn.crease_vertices;
        cage.vertex_sharpness = drawn.vertex_sharpness;
        cage.material_slots = drawn.material_slots;
        cage.uv_maps = drawn.uv_maps;
        cage.attributes = drawn.attributes;
        cage.active_uv = bytes.count(2) - 1;
        cage.border_corners = static_cast<BorderCorners>(bytes.count(1));
        cage.uv_smoothing = static_cast<UvSmoothing>(bytes.count(5));
        cage.scheme = static_cast<SubdivisionScheme>(bytes.count(1));
        std::vector<float> normals;
        if (bytes.flag()) normals = bytes.floats(3 * drawn.corners.size() + bytes.odd_length());
        cage.corner_normals = normals;
        fuzz::trace_drawn_rays(std::make_shared<SubdivisionSurface>(cage), bytes);
    });
    return 0;
}
