// Strands with any arrays: offsets that do not rise, lengths that do not fit, radii and points that are no numbers.
#include "fuzz_shapes.h"
#include "geometry/strands.h"

using namespace rayleaf;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    const size_t strands = static_cast<size_t>(bytes.count(4));
    std::vector<int32_t> offsets = {0};
    for (size_t i = 0; i < strands; ++i) offsets.push_back(offsets.back() + bytes.count(9));
    const size_t count = static_cast<size_t>(offsets.back()) + bytes.odd_length();
    if (bytes.odd_length() != 0) offsets[bytes.byte() % offsets.size()] = static_cast<int8_t>(bytes.byte());
    std::vector<double> points(3 * count);
    for (double& value : points) value = bytes.number();
    const std::vector<float> radii = bytes.ill_fitting_floats(count);
    std::vector<uint8_t> cyclic;
    if (bytes.flag())
        for (size_t i = 0; i < strands + bytes.odd_length(); ++i) cyclic.push_back(bytes.flag() ? 1 : 0);
    const std::vector<int32_t> slots = bytes.slots(strands);
    fuzz::refusing([&] {
        StrandArrays arrays;
        arrays.name = "drawn";
        arrays.points = points;
        arrays.radii = radii;
        arrays.offsets = offsets;
        arrays.cyclic = cyclic;
        arrays.material_slots = slots;
        arrays.basis = static_cast<StrandBasis>(bytes.count(3));
        arrays.form = static_cast<StrandForm>(bytes.count(3));
        arrays.spheres_per_segment = static_cast<int8_t>(bytes.byte());
        if (bytes.flag()) {
            const int channels = bytes.count(5);
            const StrandDomain domain = bytes.flag() ? StrandDomain::Point : StrandDomain::Strand;
            const size_t values = domain == StrandDomain::Point ? count : strands;
            arrays.attributes.push_back(
                {0, channels, domain, bytes.ill_fitting_floats(values * static_cast<size_t>(channels))});
            arrays.active_uv = bytes.count(1);
        }
        if (bytes.flag()) arrays.info = {1, 2, 3, 4};
        fuzz::trace_drawn_rays(std::make_shared<Strands>(std::move(arrays)), bytes);
    });
    return 0;
}
