#include "shading/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayleaf {
namespace {

constexpr float kFirst = 380.0f, kStep = 5.0f;  // nanometres
/// The observer's three sensitivities every 5 nm (CIE 15, table T.4).
constexpr std::array<std::array<float, 3>, 81> kObserver = {{
    {0.0014f, 0.0f, 0.0065f},    {0.0022f, 0.0001f, 0.0105f}, {0.0042f, 0.0001f, 0.0201f}, {0.0076f, 0.0002f, 0.0362f},
    {0.0143f, 0.0004f, 0.0679f}, {0.0232f, 0.0006f, 0.1102f}, {0.0435f, 0.0012f, 0.2074f}, {0.0776f, 0.0022f, 0.3713f},
    {0.1344f, 0.004f, 0.6456f},  {0.2148f, 0.0073f, 1.0391f}, {0.2839f, 0.0116f, 1.3856f}, {0.3285f, 0.0168f, 1.623f},
    {0.3483f, 0.023f, 1.7471f},  {0.3481f, 0.0298f, 1.7826f}, {0.3362f, 0.038f, 1.7721f},  {0.3187f, 0.048f, 1.7441f},
    {0.2908f, 0.06f, 1.6692f},   {0.2511f, 0.0739f, 1.5281f}, {0.1954f, 0.091f, 1.2876f},  {0.1421f, 0.1126f, 1.0419f},
    {0.0956f, 0.139f, 0.813f},   {0.058f, 0.1693f, 0.6162f},  {0.032f, 0.208f, 0.4652f},   {0.0147f, 0.2586f, 0.3533f},
    {0.0049f, 0.323f, 0.272f},   {0.0024f, 0.4073f, 0.2123f}, {0.0093f, 0.503f, 0.1582f},  {0.0291f, 0.6082f, 0.1117f},
    {0.0633f, 0.71f, 0.0782f},   {0.1096f, 0.7932f, 0.0573f}, {0.1655f, 0.862f, 0.0422f},  {0.2257f, 0.9149f, 0.0298f},
    {0.2904f, 0.954f, 0.0203f},  {0.3597f, 0.9803f, 0.0134f}, {0.4334f, 0.995f, 0.0087f},  {0.5121f, 1.0f, 0.0057f},
    {0.5945f, 0.995f, 0.0039f},  {0.6784f, 0.9786f, 0.0027f}, {0.7621f, 0.952f, 0.0021f},  {0.8425f, 0.9154f, 0.0018f},
    {0.9163f, 0.87f, 0.0017f},   {0.9786f, 0.8163f, 0.0014f}, {1.0263f, 0.757f, 0.0011f},  {1.0567f, 0.6949f, 0.001f},
    {1.0622f, 0.631f, 0.0008f},  {1.0456f, 0.5668f, 0.0006f}, {1.0026f, 0.503f, 0.0003f},  {0.9384f, 0.4412f, 0.0002f},
    {0.8544f, 0.381f, 0.0002f},  {0.7514f, 0.321f, 0.0001f},  {0.6424f, 0.265f, 0.0f},     {0.5419f, 0.217f, 0.0f},
    {0.4479f, 0.175f, 0.0f},     {0.3608f, 0.1382f, 0.0f},    {0.2835f, 0.107f, 0.0f},     {0.2187f, 0.0816f, 0.0f},
    {0.1649f, 0.061f, 0.0f},     {0.1212f, 0.0446f, 0.0f},    {0.0874f, 0.032f, 0.0f},     {0.0636f, 0.0232f, 0.0f},
    {0.0468f, 0.017f, 0.0f},     {0.0329f, 0.0119f, 0.0f},    {0.0227f, 0.0082f, 0.0f},    {0.0158f, 0.0057f, 0.0f},
    {0.0114f, 0.0041f, 0.0f},    {0.0081f, 0.0029f, 0.0f},    {0.0058f, 0.0021f, 0.0f},    {0.0041f, 0.0015f, 0.0f},
    {0.0029f, 0.001f, 0.0f},     {0.002f, 0.0007f, 0.0f},     {0.0014f, 0.0005f, 0.0f},    {0.001f, 0.0004f, 0.0f},
    {0.0007f, 0.0002f, 0.0f},    {0.0005f, 0.0002f, 0.0f},    {0.0003f, 0.0001f, 0.0f},    {0.0002f, 0.0001f, 0.0f},
    {0.0002f, 0.0001f, 0.0f},    {0.0001f, 0.0f, 0.0f},       {0.0001f, 0.0f, 0.0f},       {0.0001f, 0.0f, 0.0f},
    {0.0f, 0.0f, 0.0f},
}};

/// Of a mixture of lights that the observer sees as X, Y, Z; a channel may be negative.
Color unlimited_rec709(const Vec3f& xyz) {
    return {3.2404542f * xyz.x - 1.5371385f * xyz.y - 0.4985314f * xyz.z,
            -0.9692660f * xyz.x + 1.8760108f * xyz.y + 0.0415560f * xyz.z,
            0.0556434f * xyz.x - 0.2040259f * xyz.y + 1.0572252f * xyz.z};
}

/// The same without negative channels.
Color rec709(const Vec3f& xyz) {
    const Color color = unlimited_rec709(xyz);
    return {std::max(color.x, 0.0f), std::max(color.y, 0.0f), std::max(color.z, 0.0f)};
}

Vec3f observed(size_t i) {
    return {kObserver[i][0], kObserver[i][1], kObserver[i][2]};
}

}  // namespace

Color wavelength_color(float nanometres) {
    constexpr float kScale = 1.0f / 2.52f;  // Blender's: scales most channels below 1
    const float place = (nanometres - kFirst) / kStep;
    // The first interval goes on below the table, as in Cycles, where it soon turns negative.
    if (!(place > -1.0f) || !(place < static_cast<float>(kObserver.size() - 1))) return Color(0.0f);
    const auto i = static_cast<size_t>(std::max(place, 0.0f));
    const float share = place - static_cast<float>(i);
    return rec709(observed(i) * (1.0f - share) + observed(i + 1) * share) * kScale;
}

namespace {

constexpr float kColdest = 800.0f, kHottest = 12000.0f;  // kelvins; Cycles' limits
/// Colours change about evenly with the reciprocal of the temperature: a line between two of so many is exact to some
/// 10^-6.
constexpr size_t kBlackbodies = 1024;

/// The radiation of a black body as Planck's law says, of luminance 1; a channel may be negative.
Color integrated_blackbody(double kelvins) {
    constexpr double kSecondRadiation = 1.438776877e7;  // Planck's h c / k, nanometre kelvins
    Vec3d sum(0.0);
    for (size_t i = 0; i < kObserver.size(); ++i) {
        const double wavelength = double{kFirst} + double{kStep} * static_cast<double>(i);
        sum += Vec3d(observed(i)) *
               (std::pow(560.0 / wavelength, 5.0) / std::expm1(kSecondRadiation / (wavelength * kelvins)));
    }
    return unlimited_rec709(Vec3f(sum / sum.y));
}

/// By even steps of the reciprocal temperature, hottest first.
const std::array<Color, kBlackbodies + 1>& blackbodies() {
    static const auto kTable = [] {
        std::array<Color, kBlackbodies + 1> result;
        const double first = 1.0 / double{kHottest}, last = 1.0 / double{kColdest};
        for (size_t i = 0; i <= kBlackbodies; ++i)
            result[i] = integrated_blackbody(1.0 / (first + (last - first) * static_cast<double>(i) / kBlackbodies));
        return result;
    }();
    return kTable;
}

}  // namespace

Color blackbody_color(float kelvins) {
    static const std::array<Color, kBlackbodies + 1>& table = blackbodies();
    constexpr float kFirstPlace = 1.0f / kHottest, kPlaces = kBlackbodies / (1.0f / kColdest - 1.0f / kHottest);
    const float temperature = kelvins > kColdest ? std::min(kelvins, kHottest) : kColdest;
    const float place = std::clamp((1.0f / temperature - kFirstPlace) * kPlaces, 0.0f, float{kBlackbodies});
    const size_t i = std::min(static_cast<size_t>(place), kBlackbodies - 1);
    const float share = place - static_cast<float>(i);
    const Color color = table[i] * (1.0f - share) + table[i + 1] * share;
    return {std::max(color.x, 0.0f), std::max(color.y, 0.0f), std::max(color.z, 0.0f)};
}

std::span<const Sensitivity> rec709_sensitivities() {
    static const auto kSensitivities = [] {
        std::array<Sensitivity, kObserver.size()> result;
        Color sum(0.0f);
        for (size_t i = 0; i < kObserver.size(); ++i) {
            result[i] = {kFirst + kStep * static_cast<float>(i), unlimited_rec709(observed(i))};
            sum += result[i].color;
        }
        for (Sensitivity& each : result) each.color /= sum;
        return result;
    }();
    return kSensitivities;
}

}  // namespace rayleaf
