// The closures of a point taken apart, for integrators that follow every mirror and every refraction and send many rays
// from rough lobes.
#pragma once

#include "shading/closure_view.h"

#include <span>
#include <type_traits>

namespace rayleaf {

class SplitClosures {
  public:
    SplitClosures(const Closures& closures, const Vec3f& outgoing, const Vec3f& facet_normal);

    /// One sample for each mirror and each refraction, that of glass weighted by Fresnel; equal directions are joined.
    std::span<const LobeSample> singular() const { return {singular_, static_cast<size_t>(singular_count_)}; }
    /// The rough microfacet lobes.
    const Closures& glossy() const { return glossy_; }
    const ClosureView& glossy_view() const { return glossy_view_; }
    /// The lobes that scatter over the hemisphere, sampled by the cosine.
    const Closures& diffuse() const { return diffuse_; }
    const ClosureView& diffuse_view() const { return diffuse_view_; }
    /// Those by which light enters a body.
    const Closures& subsurface() const { return subsurface_; }

  private:
    /// Room that costs nothing to make: the first are there. Glass has two.
    union {
        LobeSample singular_[2 * Closures::kMaxLobes];
    };
    static_assert(std::is_trivially_destructible_v<LobeSample>);
    int singular_count_ = 0;
    Closures glossy_, diffuse_, subsurface_;
    ClosureView glossy_view_, diffuse_view_;

    /// Null: it is singular.
    Closures* class_of(const Lobe& lobe);
    /// Null: they are of several, or singular.
    Closures* class_of_all(const Closures& closures);
    void add_singular(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& facet_normal);
    void add_singular(const LobeSample& sample);
};

/// Share of light, alike from everywhere, that a lobe of `SplitClosures::diffuse` scatters to the viewer.
Color hemispherical_albedo(const Lobe& lobe, const Vec3f& outgoing);
/// True for lobes that `SplitClosures::diffuse` takes.
bool is_hemispherical(const Lobe& lobe);

}  // namespace rayleaf
