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

constexpr std::array<const char*, kMatteKinds> kMatteKeys = {"mattes_object", "mattes_material", "mattes_asset"};

/// The samples of a rectangle, sums of each pass (row, column, channel, term), and mattes (row, column, entry, id and
/// weight).
struct FilmPart {
    int x, y, width, height;
    std::vector<std::pair<Pass, Array<double>>> sums;
    std::array<std::optional<Array<double>>, kMatteKinds> mattes;
};

void check_terms(const Array<double>& array, Pass pass) {
    const int channels = static_cast<int>(info(pass).channels.size());
    const std::string name(info(pass).identifier);
    check_shape(kObject, name.c_str(), array, {-1, -1, channels, -1});
    if (array.shape(3) > ExactSums::kMostTerms)
        throw InputError(kObject, name, std::to_string(array.shape(3)) + " terms",
                         "at most " + std::to_string(ExactSums::kMostTerms));
    for (const double term : span_of(array))
        if (!ExactSums::is_term(term)) throw InputError(kObject, name, number_text(term), "terms of sums of floats");
}

using NamedSums = std::map<std::string, Array<double>>;

/// Whole numbers: an id, and a weight that leaves room for all samples.
bool is_matte_entry(double id, double weight) {
    constexpr double kMostId = 0x1p32 - 1, kMostWeight = 0x1p55;
    return id >= 0 && id <= kMostId && weight >= 0 && weight <= kMostWeight && std::floor(id) == id &&
           std::floor(weight) == weight;
}

void check_mattes(FilmPart& part, const FilmSums& film, const NamedSums& sums) {
    for (size_t kind = 0; kind < kMatteKinds && film.mattes(); ++kind) {
        if (!film.mattes()->has(static_cast<MatteKind>(kind))) continue;
        const auto found = sums.find(kMatteKeys[kind]);
        if (found == sums.end())
            throw InputError(kObject, "sums", std::string("without ") + kMatteKeys[kind], "all mattes of the film");
        check_shape(kObject, kMatteKeys[kind], found->second, {part.height, part.width, -1, 2});
        const std::span<const double> numbers = span_of(found->second);
        for (size_t i = 0; i < numbers.size(); i += 2)
            if (!is_matte_entry(numbers[i], numbers[i + 1]))
                throw InputError(kObject, kMatteKeys[kind],
                                 number_text(numbers[i]) + ", " + number_text(numbers[i + 1]),
                                 "ids and weights of mattes, whole numbers");
        part.mattes[kind] = found->second;
    }
}

FilmPart checked_part(const FilmSums& film, int x, int y, const NamedSums& sums) {
    FilmPart part{x, y, 0, 0, {}, {}};
    for (const Pass pass : film.summed_passes()) {
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
    check_mattes(part, film, sums);
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
            for (size_t i = 0; i < terms; ++i) pixel.of(pass).add_term(c, *term++);
    }
    film.add(part.x + column, part.y + row, samples, pixel);
    if (!film.mattes()) return;
    PixelMattes mattes;
    for (size_t kind = 0; kind < kMatteKinds; ++kind) {
        if (!part.mattes[kind]) continue;
        const auto entries = static_cast<size_t>(part.mattes[kind]->shape(2));
        const size_t place = static_cast<size_t>(row) * static_cast<size_t>(part.width) + static_cast<size_t>(column);
        const double* entry = part.mattes[kind]->data() + place * entries * 2;
        for (size_t i = 0; i < entries; ++i, entry += 2)
            mattes[kind].add(static_cast<uint32_t>(entry[0]), static_cast<uint64_t>(entry[1]));
    }
    film.add_mattes(part.x + column, part.y + row, samples, mattes);
}

void add(FilmSums& film, int x, int y, int samples, const NamedSums& sums) {
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

void add_mattes(const FilmSums& film, py::dict& sums) {
    if (!film.mattes()) return;
    for (size_t k = 0; k < kMatteKinds; ++k) {
        const auto kind = static_cast<MatteKind>(k);
        if (!film.mattes()->has(kind)) continue;
        size_t most = 1;
        for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x)
                most = std::max(most, film.mattes()->at(kind, x, y).entries().size());
        py::array_t<double> array(py::array::ShapeContainer{py::ssize_t{film.height()}, py::ssize_t{film.width()},
                                                            static_cast<py::ssize_t>(most), py::ssize_t{2}});
        double* out = array.mutable_data();
        std::fill_n(out, array.size(), 0.0);
        for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x, out += 2 * most)
                for (size_t i = 0; const MatteSums::Entry& entry : film.mattes()->at(kind, x, y).ranked()) {
                    out[i++] = entry.id;
                    out[i++] = static_cast<double>(entry.weight);
                }
        sums[kMatteKeys[k]] = array;
    }
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
