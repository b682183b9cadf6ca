// The world as a light: a table over latitude and longitude, sampled cell by cell in proportion to what arrives.
//
// Inside a cell the density is constant per solid angle (longitude and height are uniform there), so that the density
// asked for a direction is exactly the one it is sampled with. A small share is uniform, for what the table missed.
//
// The sun of a sky is smaller than a cell and thousands of times as bright as what is around it: suns are sampled
// apart, evenly over their discs, and the table is that of what is left without them.
//
// Where scattered rays find the world as well and both are weighed, light is better sampled where the world is brighter
// than its mean, and the rest is left to them (O. Karlik et al.: MIS Compensation: Optimizing Sampling Techniques in
// Multiple Importance Sampling, SIGGRAPH Asia 2019, the part on image-based lighting).
#pragma once

#include "base/content_hash.h"
#include "base/kept_by_key.h"
#include "lights/lamp_sample.h"
#include "lights/light.h"
#include "shading/sky.h"

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

/// Which part of the world's light is sampled; of the rest, a small share.
enum class WorldShare : uint8_t {
    All,
    AboveMean  ///< scattered rays find the rest
};

/// All that a world's table depends on.
struct WorldLightKey {
    ContentHash world{};
    int width = 0;
    WorldShare share = WorldShare::All;
    auto operator<=>(const WorldLightKey&) const = default;  // NOLINT(modernize-use-nullptr): it has no pointers
};

/// The world's radiance along many directions, which costs less than asking for one after the other.
using WorldEmissions = std::function<void(std::span<const Vec3f> directions, Color* radiances)>;

class WorldLight {
  public:
    /// At most `width` cells around, half as many from pole to pole: fewer where more would tell next to nothing.
    /// `suns`: where it is so bright. Throws Cancelled soon after `cancel` says so.
    WorldLight(const WorldEmissions& world, std::span<const SunDisc> suns, int width, WorldShare share,
               const CancelToken& cancel);

    /// True where the table found nothing, or the same everywhere: scattering alone samples such a world.
    bool is_uniform() const { return is_uniform_; }
    /// A direction with its density; the radiance is left to the caller.
    Maybe<LightSample> sample(const Vec2f& random) const;
    double density(const Vec3f& direction) const;
    /// Irradiance of a point from what is sampled of the mean world, as one number; for the choice of a light.
    double irradiance() const { return mean_ * std::numbers::pi; }
    /// Which part of the world's light is sampled; scattered rays are left to find the rest.
    double share() const { return share_; }
    size_t bytes() const;

  private:
    int width_, height_;
    std::vector<double> heights_;  ///< z of the rows' borders, from 1 down to -1
    std::vector<float> rows_;      ///< cumulated, height + 1 of them
    std::vector<float> cells_;     ///< per row, width + 1 of them
    /// Of a row, what the density in a cell is for each share of the row's probability.
    std::vector<double> row_densities_;
    /// By parts of [0, 1), the first row or cell there; of cells, row after row.
    std::vector<uint32_t> row_guide_, cell_guides_;
    double mean_ = 0, share_ = 1;
    bool is_uniform_ = true;

    /// A disc that is sampled apart.
    struct Sun {
        SunDisc disc;  ///< a little larger, so that rounding leaves nothing out
        ConeFrame towards;
        double light = 0;    ///< radiance times solid angle
        double until = 0;    ///< the probability of it and of those before it
        double density = 0;  ///< in it

        double one_minus_cosine() const { return disc.solid_angle() / (2.0 * std::numbers::pi); }
    };
    std::vector<Sun> suns_;

    double add_suns(const WorldEmissions& world, std::span<const SunDisc> suns);
    bool is_in_sun(const Vec3f& direction) const;
    void set_probabilities(double sampled);
    double sun_density(const Vec3f& direction) const;
    const float* row(int y) const { return cells_.data() + static_cast<size_t>(y) * (static_cast<size_t>(width_) + 1); }
    void coarsen(std::vector<double>& weights);
    void fill_tables(const std::vector<double>& weights);
    size_t guide_of_row(int y) const;
    int row_at(double z) const;
    double cell_density(int x, int y) const { return row_densities_[y] * (double{row(y)[x + 1]} - double{row(y)[x]}); }
};

/// Users are scenes.
class WorldLightStore final : public KeptByKey<WorldLightKey, std::shared_ptr<const WorldLight>> {};

}  // namespace rayleaf
