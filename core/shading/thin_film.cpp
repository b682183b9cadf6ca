#include "shading/thin_film.h"

#include "shading/fresnel.h"
#include "shading/interference.h"

#include <array>
#include <complex>

namespace rayleaf {
namespace {

constexpr int kTerms = 3;
constexpr float kThinnestFilm = 0.1f, kWholeFilm = 1.0f;  // nanometres

/// What an interface does to one polarization of light that it reflects.
struct Reflected {
    float share, phase;
};
struct Polarized {
    Reflected perpendicular, parallel;
};

/// Fresnel's formulas, seen under `cosine`; `index` beyond over that on the viewer's side, with the extinction as its
/// imaginary part. Beyond the angle of total reflection the wave beyond dies away.
Polarized reflected(std::complex<float> index, float cosine) {
    using namespace std::complex_literals;
    const std::complex<float> beyond2 = index * index - (1.0f - cosine * cosine);  // (index times cosine beyond)²
    const bool dies = beyond2.imag() == 0.0f && beyond2.real() < 0.0f;
    const std::complex<float> beyond = dies ? 1if * std::sqrt(-beyond2.real()) : std::sqrt(beyond2);
    const auto of = [](std::complex<float> a, std::complex<float> b) {
        const std::complex<float> amplitude = (a - b) / (a + b);
        return Reflected{std::min(std::norm(amplitude), 1.0f), std::arg(amplitude)};
    };
    return {of(cosine, beyond), of(index * index * cosine, beyond)};
}

/// A film as light crosses it: the first interface, and the cosine within.
struct FilmCrossing {
    float index;  ///< of the film, as far as there is one
    Polarized outer;
    float cosine;  ///< to the normal, within the film
    float path;    ///< nanometres, there and back
    bool total;    ///< nothing enters
};

FilmCrossing crossing(const ThinFilm& film, float cosine) {
    constexpr float kLeastIndex = 1e-3f;
    const float x = std::clamp(film.thickness / kWholeFilm, 0.0f, 1.0f);
    const float there = x * x * (3.0f - 2.0f * x);
    FilmCrossing result{};
    result.index = std::max(1.0f + (film.ior - 1.0f) * there, kLeastIndex);
    const float c = std::clamp(cosine, 0.0f, 1.0f);
    const float within2 = 1.0f - (1.0f - c * c) / (result.index * result.index);
    result.total = !(within2 > 0.0f) || c == 0.0f;
    if (result.total) return result;
    result.outer = reflected(result.index, c);
    result.cosine = std::sqrt(within2);
    result.path = 2.0f * result.index * film.thickness * result.cosine;
    return result;
}

/// Light that is reflected below in one way, alike in all channels or not.
struct Below {
    Color share, phase;
};

/// Airy's sum for one polarization.
Color airy_sum(FilmObserver observer, const Reflected& outer, const Below& below, float path) {
    const float enters = 1.0f - outer.share;
    const Color both = below.share * outer.share;
    Color sum, term, step;
    for (int c = 0; c < 3; ++c) {
        const float repeated =
            below.share[c] < 1.0f ? enters * enters * below.share[c] / (1.0f - both[c]) : 1.0f - outer.share;
        sum[c] = outer.share + repeated;
        term[c] = below.share[c] < 1.0f ? repeated - enters : 0.0f;
        step[c] = std::sqrt(both[c]);
    }
    // Inside, the outer interface reflects in the opposite phase.
    const Color phase = below.phase + Color(kPi - outer.phase);
    for (int m = 1; m <= kTerms; ++m) {
        const auto times = static_cast<float>(m);
        term = term * step;
        sum += term * seen_interference(observer, path * times, phase * times) * 2.0f;
    }
    return sum;
}

/// Both polarizations; `below(parallel)` says what the lower interface does to each.
template <typename Function>
Color filmed(const ThinFilm& film, const FilmCrossing& crossing, Function below) {
    const Color perpendicular = airy_sum(film.observer, crossing.outer.perpendicular, below(false), crossing.path);
    const Color parallel = airy_sum(film.observer, crossing.outer.parallel, below(true), crossing.path);
    const Color mean = (perpendicular + parallel) * 0.5f;
    return {std::clamp(mean.x, 0.0f, 1.0f), std::clamp(mean.y, 0.0f, 1.0f), std::clamp(mean.z, 0.0f, 1.0f)};
}

/// Of three channels with an index each, as seen from within the film.
std::array<Polarized, 3> reflected_below(const FilmCrossing& crossing, const Color& index, const Color& extinction) {
    std::array<Polarized, 3> result;
    for (int c = 0; c < 3; ++c)
        result[static_cast<size_t>(c)] =
            reflected(std::complex<float>(index[c], extinction[c]) / crossing.index, crossing.cosine);
    return result;
}
Below joined(const std::array<Polarized, 3>& channels, bool parallel) {
    Below below{Color(0.0f), Color(0.0f)};
    for (int c = 0; c < 3; ++c) {
        const Polarized& each = channels[static_cast<size_t>(c)];
        const Reflected& one = parallel ? each.parallel : each.perpendicular;
        below.share[c] = one.share;
        below.phase[c] = one.phase;
    }
    return below;
}

/// The index and the extinction of a metal by its reflectance at normal incidence and near grazing (Gulbrandsen 2014).
struct MetalIndex {
    float index, extinction;
};
MetalIndex metal_index(float reflectance, float at_edge) {
    constexpr float kMost = 0.999f;  // of a perfect mirror the index is not known
    const float r = std::clamp(reflectance, 0.0f, kMost), g = std::clamp(at_edge, 0.0f, 1.0f), root = std::sqrt(r);
    const float n = g * (1.0f - r) / (1.0f + r) + (1.0f - g) * (1.0f + root) / (1.0f - root);
    const float k2 = (r * (n + 1.0f) * (n + 1.0f) - (n - 1.0f) * (n - 1.0f)) / (1.0f - r);
    return {n, std::sqrt(std::max(k2, 0.0f))};
}

}  // namespace

Color film_on_dielectric(const ThinFilm& film, float ior, float cosine) {
    if (!(film.thickness > kThinnestFilm)) return Color(dielectric_fresnel(cosine, ior));
    const FilmCrossing across = crossing(film, cosine);
    if (across.total) return Color(1.0f);
    const Polarized below = reflected(ior / across.index, across.cosine);
    return filmed(film, across, [&](bool parallel) {
        const Reflected& one = parallel ? below.parallel : below.perpendicular;
        return Below{Color(one.share), Color(one.phase)};
    });
}

Color film_on_conductor(const ThinFilm& film, const Color& index, const Color& extinction, float cosine) {
    if (!(film.thickness > kThinnestFilm)) return conductor_fresnel(index, extinction, cosine);
    const FilmCrossing across = crossing(film, cosine);
    if (across.total) return Color(1.0f);
    const auto channels = reflected_below(across, index, extinction);
    return filmed(film, across, [&](bool parallel) { return joined(channels, parallel); });
}

Color film_on_metal(const ThinFilm& film, const Color& fresnel_0, const Color& dip, float cosine) {
    if (!(film.thickness > kThinnestFilm)) return metal_fresnel(fresnel_0, dip, cosine);
    const FilmCrossing across = crossing(film, cosine);
    if (across.total) return Color(1.0f);
    // The phase is a conductor's; how the share rises, as seen from within the film, the metal's own curve.
    const Color tint = metal_tint(fresnel_0, dip), edge = metal_fresnel(fresnel_0, dip, kMetalEdge);
    Color index, extinction, normal_share;
    for (int c = 0; c < 3; ++c) {
        const MetalIndex own = metal_index(fresnel_0[c], edge[c]);
        index[c] = own.index;
        extinction[c] = own.extinction;
        normal_share[c] = reflected(std::complex<float>(own.index, own.extinction) / across.index, 1.0f).parallel.share;
    }
    const Color share = metal_fresnel(normal_share, metal_dip(normal_share, tint), across.cosine);
    const auto channels = reflected_below(across, index, extinction);
    return filmed(film, across, [&](bool parallel) {
        Below below = joined(channels, parallel);
        below.share = share;
        return below;
    });
}

}  // namespace rayleaf
