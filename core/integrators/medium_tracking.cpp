#include "integrators/medium_tracking.h"

#include "integrators/medium_majorants.h"

namespace rayleaf {
namespace {

/// Null collisions on one segment: beyond these a medium is taken to end.
constexpr int kMostCollisions = 4096;
/// Light dimmer than this share of what it was goes on by chance.
constexpr float kFaint = 0.02f, kFaintSurvival = 0.25f;
/// The least share of the places from which light is looked for that do not go by where it is.
constexpr double kLeastByDistance = 0.2;

float exponential(float extinction, double t) {
    return extinction > 0.0f ? static_cast<float>(std::exp(-static_cast<double>(extinction) * t)) : 1.0f;
}

Color exponential(const Color& extinction, double t) {
    return {exponential(extinction.x, t), exponential(extinction.y, t), exponential(extinction.z, t)};
}

/// Length over which light that is emitted evenly gets to the begin of a segment; none where that has no end.
float lit_length(float extinction, double end) {
    const double depth = static_cast<double>(extinction) * end;
    if (depth > 0.0) return static_cast<float>(-std::expm1(-depth) / static_cast<double>(extinction));
    return std::isfinite(end) ? static_cast<float>(end) : 0.0f;
}

/// With which probability each channel decides on a distance: by how much of its light there is.
Color shares_of(const Color& throughput) {
    const Color size(std::max(throughput.x, 0.0f), std::max(throughput.y, 0.0f), std::max(throughput.z, 0.0f));
    const float sum = size.x + size.y + size.z;
    return sum > 0.0f && std::isfinite(sum) ? size / sum : Color(1.0f / 3.0f);
}

int channel_of(const Color& shares, float random) {
    if (random < shares.x) return 0;
    return random < shares.x + shares.y || !(shares.z > 0.0f) ? 1 : 2;
}

/// What is denser than its bound is as dense as that: else few paths would carry most of the light.
Closures limited(Closures closures, float majorant) {
    MediumClosures& medium = closures.medium;
    const float largest = max_component(medium.extinction);
    if (!(largest > majorant)) return closures;
    const float factor = majorant / largest;
    medium.extinction *= factor;
    for (int i = 0; i < medium.count; ++i) medium.phases[static_cast<size_t>(i)].scattering *= factor;
    return closures;
}

/// Goes from one tentative collision to the next; `visit(t, majorant)` says whether to go on.
template <typename Visit>
void track(const MediumSegment& segment, RandomStream& random, const Visit& visit) {
    const Majorants majorants(segment);
    double t = 0.0, border = 0.0;
    MajorantStep step;
    for (int i = 0; i < kMostCollisions && t < segment.end; ++i) {
        if (t >= border) {
            step = majorants.at(t);
            border = std::min(step.end, segment.end);
        }
        double next = std::numeric_limits<double>::infinity();
        if (step.majorant > 0.0f)
            next = t - std::log1p(-static_cast<double>(random.next())) / static_cast<double>(step.majorant);
        t = std::min(next, border);
        if (next < border && !visit(t, step.majorant)) return;
    }
}

/// Ends faint light by chance; the rest is brighter.
bool stays(Color& light, RandomStream& random) {
    const float largest = max_abs(light);
    if (largest >= kFaint) return true;
    if (!(largest > 0.0f) || random.next() >= kFaintSurvival) {
        light = Color(0.0f);
        return false;
    }
    light /= kFaintSurvival;
    return true;
}

MediumPassage pass_even(const MediumSegment& segment, const Color& throughput, bool scatters, const Vec2f& distance) {
    const Closures closures = segment.at(0.0);
    const Color& extinction = closures.medium.extinction;
    MediumPassage passage;
    for (int c = 0; c < 3; ++c) passage.emission[c] = closures.emission[c] * lit_length(extinction[c], segment.end);
    passage.weight = exponential(extinction, segment.end);
    if (!scatters || !closures.medium.scatters()) return passage;
    const Color shares = shares_of(throughput);
    const float chosen = extinction[channel_of(shares, distance.y)];
    const double t = chosen > 0.0f ? -std::log1p(-static_cast<double>(distance.x)) / static_cast<double>(chosen)
                                   : std::numeric_limits<double>::infinity();
    if (!(t < segment.end)) {
        passage.weight /= shares.dot(passage.weight);
        return passage;
    }
    const Color through = exponential(extinction, t);
    passage.weight = through / (shares * extinction).dot(through);
    passage.t = t;
    passage.medium = closures.medium;
    return passage;
}

MediumPassage pass_varying(const MediumSegment& segment, const Color& throughput, bool scatters, RandomStream& random) {
    MediumPassage passage;
    track(segment, random, [&](double t, float majorant) {
        const Closures closures = limited(segment.at(t), majorant);
        passage.emission += passage.weight * closures.emission / majorant;
        const Color& extinction = closures.medium.extinction;
        const Color null = Color(majorant) - extinction;
        if (!scatters || !closures.medium.scatters()) {
            passage.weight *= null / majorant;
            return stays(passage.weight, random);
        }
        const Color shares = shares_of(throughput * passage.weight);
        const float real = shares.dot(extinction);
        const float probability = real / (real + shares.dot(null));
        if (random.next() >= probability) {
            passage.weight *= null / (majorant * (1.0f - probability));
            return stays(passage.weight, random);
        }
        passage.weight /= majorant * probability;
        passage.t = t;
        passage.medium = closures.medium;
        return false;
    });
    return passage;
}

/// Places by how much light arrives there if nothing dims it: seen from a light they are spread over even angles
/// (Kulla and Fajardo 2012); each light has the share that it gives of all.
class ByLight {
  public:
    template <typename ByDistance>
    ByLight(const MediumSegment& segment, const PassedLights& passed, const ByDistance& by_distance) {
        double straight = 0.0;
        for (const PassedLight& light : passed.all()) {
            const Vec3d to_light = light.center - segment.ray.origin;
            View& view = views_[count_++];
            view.begin = light.begin;
            view.end = light.end;
            view.nearest = to_light.dot(segment.ray.direction);
            // What is nearer than its size brings no more light than that.
            const double beside_squared = (to_light - segment.ray.direction * view.nearest).length2();
            view.distance = std::max(std::sqrt(beside_squared + light.radius * light.radius), kLeastDistance);
            view.first = std::atan2(light.begin - view.nearest, view.distance);
            view.last =
                std::isfinite(light.end) ? std::atan2(light.end - view.nearest, view.distance) : std::numbers::pi / 2;
            const double spread = (view.last - view.first) / view.distance;
            const double nearest = std::clamp(view.nearest, view.begin, view.end);
            const double beside = std::hypot(nearest - view.nearest, view.distance);
            straight += light.intensity * spread * by_distance.dimmed(0.0, to_light.length());
            view.intensity = light.intensity * by_distance.dimmed(nearest, beside);
            view.arriving = view.intensity * spread;
            total_ += view.arriving;
        }
        if (total_ > 0.0 && std::isfinite(straight))
            share_ = (1.0 - kLeastByDistance) * (1.0 - passed.far_share) * std::min(total_ / straight, 1.0);
    }
    /// Of the places that are to be chosen so: few where light that makes the detour by there is lost on the way.
    double share() const { return share_; }
    double sample(double random) const {
        double left = random * total_;
        size_t chosen = 0;
        while (chosen + 1 < count_ && left >= views_[chosen].arriving) left -= views_[chosen++].arriving;
        const View& view = views_[chosen];
        const double angle = view.first + (view.last - view.first) * std::min(left / view.arriving, 1.0);
        return std::clamp(view.nearest + view.distance * std::tan(angle), view.begin, view.end);
    }
    double density(double t) const {
        double arriving = 0.0;
        for (const View& view : std::span(views_.data(), count_)) {
            const double along = t - view.nearest;
            if (t >= view.begin && t <= view.end)
                arriving += view.intensity / (view.distance * view.distance + along * along);
        }
        return arriving / total_;
    }

  private:
    static constexpr double kLeastDistance = 1e-6;  ///< world units: a light on the ray itself
    struct View {
        double begin, end;         ///< of PassedLight
        double intensity;          ///< as the medium dims it
        double nearest, distance;  ///< where on the ray, and how far from it
        double first, last;        ///< angles from there
        double arriving;           ///< in all
    };
    std::array<View, PassedLights::kMost> views_;
    size_t count_ = 0;
    double total_ = 0, share_ = 0;
};

/// A place and its density, by one of two techniques.
template <typename ByDistance>
std::optional<std::pair<double, double>> chosen_place(const MediumSegment& segment, const ByDistance& by_distance,
                                                      const PassedLights& passed, float random) {
    const ByLight by_light(segment, passed, by_distance);
    const double share = by_light.share();
    const auto number = static_cast<double>(random);
    const double t = number < share ? by_light.sample(number / share)
                                    : by_distance.sample(static_cast<float>((number - share) / (1.0 - share)));
    if (!(t >= 0.0 && t < segment.end)) return std::nullopt;
    double density = (1.0 - share) * by_distance.density(t);
    if (share > 0.0) density += share * by_light.density(t);
    if (!(density > 0.0) || !std::isfinite(density)) return std::nullopt;
    return std::pair(t, density);
}

/// As pass_even's, but within the segment.
struct EvenDepth {
    const Color& extinction;
    Color shares;
    int channel;
    double end;

    /// Light from `beside` the ray at `t`, at its origin.
    double dimmed(double t, double beside) const {
        const float thinnest = std::min({extinction.x, extinction.y, extinction.z});
        return std::exp(-static_cast<double>(thinnest) * (t + beside));
    }
    double part(int c) const { return -std::expm1(-static_cast<double>(extinction[c]) * end); }
    double sample(float random) const {
        if (!(extinction[channel] > 0.0f)) return std::numeric_limits<double>::infinity();
        return -std::log1p(-static_cast<double>(random) * part(channel)) / static_cast<double>(extinction[channel]);
    }
    double density(double t) const {
        double sum = 0.0;
        for (int c = 0; c < 3; ++c)
            if (extinction[c] > 0.0f)
                sum += static_cast<double>(shares[c] * extinction[c] * exponential(extinction[c], t)) / part(c);
        return sum;
    }
};

}  // namespace

Closures MediumSegment::at(double t) const {
    Closures sum;
    const std::span<const SceneMedium* const> all = media.all();
    scene.media().evaluate(*all.front(), ray.at(t), outgoing(), state, sum);
    for (const SceneMedium* medium : all.subspan(1)) {
        Closures more;
        scene.media().evaluate(*medium, ray.at(t), outgoing(), state, more);
        sum.medium.add(more.medium);
        sum.emission += more.emission;
    }
    return sum;
}

Color transmittance(const MediumSegment& segment, RandomStream& random) {
    if (!segment.media.varies()) return exponential(segment.at(0.0).medium.extinction, segment.end);
    Color through(1.0f);
    track(segment, random, [&](double t, float majorant) {
        through *= (Color(majorant) - limited(segment.at(t), majorant).medium.extinction) / majorant;
        return stays(through, random);
    });
    return through;
}

MediumPassage pass(const MediumSegment& segment, const Color& throughput, bool scatters, const Vec2f& distance,
                   RandomStream& random) {
    if (segment.media.varies()) return pass_varying(segment, throughput, scatters, random);
    return pass_even(segment, throughput, scatters, distance);
}

std::optional<LitPlace> place_of_light(const MediumSegment& segment, const Color& throughput,
                                       const PassedLights& passed, const Vec2f& place, RandomStream& random) {
    if (!segment.media.varies()) {
        const MediumClosures medium = segment.at(0.0).medium;
        if (!medium.scatters()) return std::nullopt;
        const Color shares = shares_of(throughput);
        const EvenDepth depth{medium.extinction, shares, channel_of(shares, place.y), segment.end};
        const auto chosen = chosen_place(segment, depth, passed, place.x);
        if (!chosen) return std::nullopt;
        const Color through = exponential(medium.extinction, chosen->first);
        return LitPlace{chosen->first, through / static_cast<float>(chosen->second), medium};
    }
    const Majorants majorants(segment);
    const auto chosen = chosen_place(segment, RoughDepth(majorants, segment.end), passed, place.x);
    if (!chosen) return std::nullopt;
    const float majorant = majorants.at(chosen->first).majorant;
    const MediumClosures medium = limited(segment.at(chosen->first), majorant).medium;
    if (!medium.scatters()) return std::nullopt;
    const MediumSegment up_to{segment.scene, segment.media, segment.ray, chosen->first, segment.state};
    return LitPlace{chosen->first, transmittance(up_to, random) / static_cast<float>(chosen->second), medium};
}

double likely_distance(const MediumSegment& segment, float random) {
    const double t = RoughDepth(Majorants(segment), segment.end).sample(random);
    if (std::isfinite(t)) return std::min(t, segment.end);
    return std::isfinite(segment.end) ? static_cast<double>(random) * segment.end : 0.0;
}

}  // namespace rayleaf
