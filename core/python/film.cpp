#include "python/film.h"

#include "base/error.h"
#include "python/arrays.h"

#include <map>

namespace rayleaf {
namespace {

constexpr const char* kObject = "film sums";

std::vector<Pass> known_passes(const std::vector<std::string>& names) {
    std::vector<Pass> passes;
    for (const std::string& name : names) {
        const std::optional<Pass> pass = find_pass(name);
        if (!pass) throw InputError(kObject, "passes", "'" + name + "'", "passes of the table in film/passes.def");
        passes.push_back(*pass);
    }
    return computed_passes(passes);
}

std::unique_ptr<FilmSums> make_film_sums(int width, int height, const std::vector<std::string>& passes) {
    constexpr int kLargestSide = 65536;
    if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
        throw InputError(kObject, "size", std::to_string(width) + " x " + std::to_string(height),
                         "sides from 1 to " + std::to_string(kLargestSide));
    return std::make_unique<FilmSums>(width, height, known_passes(passes));
}

/// The samples of a rectangle, sums of each pass (row, column, channel, term).
struct FilmPart {
    int x, y, width, height;
    std::vector<std::pair<Pass, Array<double>>> sums;
};

void check_terms(const Array<double>& array, Pass pass) {
    const int channels = static_cast<int>(info(pass).channels.size());
    const std::string name(info(pass).identifier);
    check_shape(kObject, name.c_str(), array, {-1, -1, channels, -1});
    if (array.shape(3) > ExactSum::kMostTerms)
        throw InputError(kObject, name, std::to_string(array.shape(3)) + " terms",
                         "at most " + std::to_string(ExactSum::kMostTerms));
    for (const double term : span_of(array))
        if (!ExactSum::is_term(term)) throw InputError(kObject, name, number_text(term), "terms of sums of floats");
}

FilmPart checked_part(const FilmSums& film, int x, int y, const std::map<std::string, Array<double>>& sums) {
    FilmPart part{x, y, 0, 0, {}};
    for (const Pass pass : film.passes()) {
        const std::string name(info(pass).identifier);
        const auto found = sums.find(name);
        if (found == sums.end()) throw InputError(kObject, "sums", "without " + name, "all passes of the film");
        const Array<double>& array = found->second;
        check_terms(array, pass);
        const auto height = static_cast<int>(array.shape(0)), width = static_cast<int>(array.shape(1));
        if (!part.sums.empty() && (height != part.height || width != part.width))
            throw InputError(kObject, name, "of another size than the passes before it", "one size for all");
        part.width = width;
        part.height = height;
        part.sums.emplace_back(pass, array);
    }
    if (x < 0 || y < 0 || x > film.width() - part.width || y > film.height() - part.height)
        throw InputError(kObject, "place",
                         std::to_string(part.width) + " x " + std::to_string(part.height) + " pixels at " +
                             std::to_string(x) + ", " + std::to_string(y),
                         "a rectangle inside the film");
    return part;
}

void add_pixel(FilmSums& film, const FilmPart& part, int column, int row, int samples) {
    PixelSums pixel;
    for (const auto& [pass, array] : part.sums) {
        const auto channels = static_cast<size_t>(array.shape(2)), terms = static_cast<size_t>(array.shape(3));
        const size_t place = static_cast<size_t>(row) * static_cast<size_t>(part.width) + static_cast<size_t>(column);
        const double* term = array.data() + place * channels * terms;
        for (size_t c = 0; c < channels; ++c)
            for (size_t i = 0; i < terms; ++i) pixel.sum(pass, c).add_term(*term++);
    }
    film.add(part.x + column, part.y + row, samples, pixel);
}

void add(FilmSums& film, int x, int y, int samples, const std::map<std::string, Array<double>>& sums) {
    constexpr int kMost = 1 << 24;
    if (samples < 1 || samples > kMost - film.most_samples())
        throw InputError(kObject, "samples", std::to_string(samples), "1 or more, 2^24 in all");
    const FilmPart part = checked_part(film, x, y, sums);
    const py::gil_scoped_release release;
    for (int row = 0; row < part.height; ++row)
        for (int column = 0; column < part.width; ++column) add_pixel(film, part, column, row, samples);
}

py::array_t<float> pass_pixels(const FilmSums& film, const std::string& name) {
    const std::optional<Pass> pass = find_pass(name);
    if (!pass || !film.has(*pass)) throw InputError(kObject, "pass", "'" + name + "'", "one of the film's passes");
    return array_of(film.pixels(*pass), film.width(), film.height(), *pass);
}

}  // namespace

py::array_t<float> array_of(std::vector<float>&& pixels, int width, int height, Pass pass) {
    auto owner = std::make_unique<std::vector<float>>(std::move(pixels));
    float* const data = owner->data();
    const py::capsule capsule(owner.release(), [](void* memory) { delete static_cast<std::vector<float>*>(memory); });
    const auto channels = static_cast<py::ssize_t>(info(pass).channels.size());
    const py::array::ShapeContainer shape{py::ssize_t{height}, py::ssize_t{width}, channels};
    return py::array_t<float>(shape, data, capsule);
}

py::array_t<double> sums_of(const FilmSums& film, Pass pass) {
    const std::vector<std::vector<double>>& terms = film.terms(pass);
    const auto channels = static_cast<py::ssize_t>(info(pass).channels.size());
    py::array_t<double> array(py::array::ShapeContainer{py::ssize_t{film.height()}, py::ssize_t{film.width()}, channels,
                                                        static_cast<py::ssize_t>(terms.size())});
    double* out = array.mutable_data();
    for (size_t i = 0; i < terms.front().size(); ++i)
        for (const std::vector<double>& term : terms) *out++ = term[i];
    return array;
}

void bind_film(py::module_& module) {
    using namespace py::literals;
    py::class_<FilmSums>(module, "FilmSums",
                         "Puts together what was rendered in parts: other pixels, other samples. The same bits as "
                         "rendered at once.")
        .def(py::init(&make_film_sums), "width"_a, "height"_a, "passes"_a)
        .def("add", &add, "x"_a, "y"_a, "samples"_a, "sums"_a)
        .def("samples", [](const FilmSums& film) { return std::make_pair(film.least_samples(), film.most_samples()); })
        .def("pass_pixels", &pass_pixels, "name"_a);
}

}  // namespace rayleaf
