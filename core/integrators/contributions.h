// Where the light of one path goes: Combined, and the passes that split it by where it came from.
#pragma once

#include "film/pixel.h"
#include "integrators/path.h"
#include "shading/closures.h"

#include <array>

namespace rayleaf {

/// One colour for each kind of lobe.
struct ByKind {
    std::array<Color, 3> of{Color(0.0f), Color(0.0f), Color(0.0f)};
    bool in_medium = false;  ///< no lobe: a medium scattered the light first

    Color& operator[](LobeKind kind) { return of[static_cast<size_t>(kind)]; }
    const Color& operator[](LobeKind kind) const { return of[static_cast<size_t>(kind)]; }
};

/// Of what a medium scattered first.
inline const ByKind kMediumFirst{.in_medium = true};

inline constexpr std::array kLobeKinds = {LobeKind::Diffuse, LobeKind::Glossy, LobeKind::Transmission};

class Contributions {
    const PathSettings& settings_;

  public:
    explicit Contributions(const PathSettings& settings) : settings_(settings), sample(settings.held_passes) {}

    /// Light the camera sees without any scattering: emitted by a surface, or the world's. Here and below `group` is
    /// the slot of the light's group, -1 for none.
    void add_seen(Pass pass, const Color& light, int group);
    /// The world behind a transparent film: in its pass, not in the picture.
    void add_hidden_world(const Color& light);
    /// Light that the first surface scattered straight from a light, split by the kinds of its lobes.
    /// `share` is the part of a camera sample that the light stands for; limits are for whole ones.
    void add_first(const Color& light, const ByKind& shares, int group, float share = 1.0f);
    /// Light that came over `scatterings` (at least one) surfaces, the first of which passed it on in `first_shares`.
    void add_scattered(const Color& light, int scatterings, const ByKind& first_shares, int group, float share = 1.0f);
    /// Colour of the lobes of each kind, of a surface the camera sees.
    void add_albedo(const ByKind& albedo);

    PixelSample sample;

    /// Ends the path: exposure and alpha.
    void finish(float alpha);

  private:
    void add_split(const Color& light, const ByKind& shares, bool direct, int group);
};

/// Shares of `total`, channel by channel, in what each kind gave; zero where the total is.
ByKind shares_of(const ByKind& parts, const Color& total);

}  // namespace rayleaf
