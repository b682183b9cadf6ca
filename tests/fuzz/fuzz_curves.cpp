// Bevelled curves with any numbers and flags: refused with a message, or traced without harm.
#include "fuzz_shapes.h"
#include "geometry/swept_surface.h"

using namespace rayleaf;

namespace {

CurveSplines splines(fuzz::Bytes& bytes, int most_points) {
    CurveSplines drawn;
    drawn.type = static_cast<CurveSplineType>(bytes.count(2));
    drawn.nurbs = {bytes.count(7), bytes.flag(), bytes.flag(), bytes.flag()};
    for (int i = bytes.count(2); i > 0; --i) drawn.counts.push_back(static_cast<uint32_t>(bytes.count(most_points)));
    size_t points = 0;
    for (const uint32_t count : drawn.counts) points += count;
    points += bytes.odd_length();
    const auto numbers = [&bytes](size_t size) {
        std::vector<double> values(size);
        for (double& value : values) value = bytes.number();
        return values;
    };
    const bool weighted = bytes.flag();
    for (size_t i = 0; i < points; ++i)
        drawn.points.emplace_back(bytes.number(), bytes.number(), bytes.number(), weighted ? bytes.number() : 1.0);
    if (drawn.type == CurveSplineType::Bezier)
        for (size_t i = 0; i < 2 * points + bytes.odd_length(); ++i)
            drawn.handles.emplace_back(bytes.number(), bytes.number(), bytes.number());
    if (bytes.flag()) drawn.radii = numbers(points + bytes.odd_length());
    if (bytes.flag()) drawn.tilts = numbers(points + bytes.odd_length());
    if (bytes.flag())
        for (size_t i = 0; i < points; ++i) drawn.straight.push_back(bytes.flag() ? 1 : 0);
    drawn.radius_interpolation = static_cast<PointInterpolation>(bytes.count(3));
    drawn.tilt_interpolation = static_cast<PointInterpolation>(bytes.count(3));
    drawn.resolution = bytes.count(14);
    drawn.material_slot = bytes.count(3);
    drawn.smooth = bytes.flag();
    return drawn;
}

SweptCurveDescription curve(fuzz::Bytes& bytes) {
    SweptCurveDescription drawn;
    drawn.name = "drawn";
    for (int i = bytes.count(1); i >= 0; --i) drawn.splines.push_back(splines(bytes, 5));
    drawn.dimensions = static_cast<CurveDimensions>(bytes.count(1));
    drawn.twist = static_cast<TwistMethod>(bytes.count(2));
    drawn.closed_twist = static_cast<ClosedTwist>(bytes.count(1));
    drawn.bevel_depth = bytes.number();
    for (double* value : {&drawn.extrude, &drawn.offset, &drawn.bevel_start, &drawn.bevel_end})
        if (bytes.flag()) *value = bytes.number();
    drawn.fill = static_cast<BevelFill>(bytes.count(3));
    drawn.bevel_resolution = bytes.count(40);
    if (bytes.flag()) drawn.profile = std::vector<CurveSplines>{splines(bytes, 4)};
    if (bytes.flag()) drawn.taper = splines(bytes, 4);
    drawn.taper_radius = static_cast<TaperRadius>(bytes.count(2));
    drawn.taper_fits_bevel = bytes.flag();
    drawn.start_mapping = static_cast<BevelMapping>(bytes.count(2));
    drawn.end_mapping = static_cast<BevelMapping>(bytes.count(2));
    drawn.fill_caps = bytes.flag();
    for (int i = bytes.count(2); i > 0; --i) drawn.fill_materials.push_back(bytes.count(4) - 1);
    return drawn;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    // A long curve that is very thin is cut into a million parts. That is right, and slow here.
    if (bytes.byte() % 8 != 0) bytes.tame();
    fuzz::refusing([&] {
        const SweptCurveDescription drawn = curve(bytes);
        fuzz::trace_drawn_rays(std::make_shared<SweptSurface>(drawn), bytes);
    });
    return 0;
}
