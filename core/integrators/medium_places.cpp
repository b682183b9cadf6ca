// Places in media from which sampled light is looked for.
#include "integrators/medium_majorants.h"
#include "integrators/medium_weights.h"

namespace rayleaf {
namespace {

/// The least share of the places from which light is looked for that do not go by where it is.
constexpr double kLeastByDistance = 0.2;

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
        const Color through = exponential(extinction, t);
        double sum = 0.0, part = 0.0;
        for (int c = 0; c < 3; ++c) {
            if (c == 0 || extinction[c] != extinction[c - 1]) part = this->part(c);
            if (extinction[c] > 0.0f) sum += static_cast<double>(shares[c] * extinction[c] * through[c]) / part;
        }
        return sum;
    }
};

}  // namespace

std::optional<LitPlace> place_of_light(const MediumSegment& segment, const SegmentBounds& bounds,
                                       const Color& throughput, const PassedLights& passed, const Vec2f& place,
                                       RandomStream& random) {
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
    const auto chosen = chosen_place(segment, bounds, passed, place.x);
    if (!chosen) return std::nullopt;
    const MediumClosures medium = limited(segment.at(chosen->first), bounds.at(chosen->first).limit).medium;
    if (!medium.scatters()) return std::nullopt;
    const MediumSegment up_to{segment.scene, segment.media, segment.ray, chosen->first, segment.state};
    return LitPlace{chosen->first, transmittance(up_to, bounds, random) / static_cast<float>(chosen->second), medium};
}

double likely_distance(const MediumSegment& segment, const SegmentBounds& bounds, float random) {
    const double t = bounds.sample(random);
    if (std::isfinite(t)) return std::min(t, segment.end);
    return std::isfinite(segment.end) ? static_cast<double>(random) * segment.end : 0.0;
}

}  // namespace rayleaf
