// NURBS surfaces with any numbers and flags: refused with a message, or traced without harm.
#include "fuzz_shapes.h"
#include "geometry/patch_surface.h"

using namespace rayleaf;

namespace {

NurbsDirection direction(fuzz::Bytes& bytes) {
    return {bytes.count(8), bytes.flag(), bytes.flag(), bytes.flag()};
}

NurbsSpline spline(fuzz::Bytes& bytes) {
    NurbsSpline drawn;
    drawn.surface.count_u = bytes.count(7);
    drawn.surface.count_v = bytes.count(7);
    drawn.surface.u = direction(bytes);
    drawn.surface.v = direction(bytes);
    drawn.smooth = bytes.flag();
    drawn.material_slot = bytes.count(3);
    const bool plain_weights = bytes.flag();
    for (int i = 0; i < drawn.surface.count_u * drawn.surface.count_v; ++i)
        drawn.surface.points.emplace_back(bytes.number(), bytes.number(), bytes.number(),
                                          plain_weights ? 1.0 : bytes.number());
    if (bytes.byte() == 7 && !drawn.surface.points.empty()) drawn.surface.points.pop_back();
    return drawn;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    fuzz::refusing([&] {
        std::vector<NurbsSpline> splines;
        for (int i = bytes.count(2); i >= 0; --i) splines.push_back(spline(bytes));
        fuzz::trace_drawn_rays(std::make_shared<PatchSurface>("drawn", splines), bytes);
    });
    return 0;
}
