#include "render/denoiser.h"

#include "base/error.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace rayleaf {
namespace {

constexpr std::pair<const char*, DenoisingGuides> kPrefilters[] = {
    {"NONE", DenoisingGuides::AsTheyAre}, {"FAST", DenoisingGuides::Noisy}, {"ACCURATE", DenoisingGuides::Denoised}};

py::array_t<float> denoised_picture(const Denoiser& denoiser, const Array<float>& color,
                                    const std::optional<Array<float>>& albedo,
                                    const std::optional<Array<float>>& normal, const std::string& prefilter) {
    check_shape("denoiser", "color", color, {-1, -1, 3});
    const py::ssize_t height = color.shape(0), width = color.shape(1);
    NoisyPicture picture{static_cast<int>(width),
                         static_cast<int>(height),
                         span_of(color),
                         {},
                         {},
                         named("denoiser", "prefilter", prefilter, kPrefilters)};
    const auto guide = [&](const std::optional<Array<float>>& image, const char* name) {
        if (!image) return std::span<const float>();
        check_shape("denoiser", name, *image, {height, width, 3});
        return span_of(*image);
    };
    picture.albedo = guide(albedo, "albedo");
    picture.normal = guide(normal, "normal");
    py::array_t<float> result({height, width, py::ssize_t{3}});
    std::vector<float> pixels;
    {
        const py::gil_scoped_release released;
        pixels = denoiser.denoised(picture);
    }
    std::copy(pixels.begin(), pixels.end(), result.mutable_data());
    return result;
}

}  // namespace

void bind_denoiser(py::module_& module) {
    using namespace py::literals;
    py::class_<Denoiser>(module, "Denoiser", "Open Image Denoise, of the process, one of the paths or the system.")
        .def(py::init<const std::vector<std::string>&, int>(), "paths"_a = std::vector<std::string>(), "threads"_a = 0)
        .def_property_readonly("version", &Denoiser::version)
        .def("denoised", &denoised_picture, "color"_a, "albedo"_a = py::none(), "normal"_a = py::none(),
             "prefilter"_a = "ACCURATE");
}

}  // namespace rayleaf
