// What guides a denoiser: the first surface of a path that is rough, seen through mirrors and clear glass.
#pragma once

#include "film/pixel.h"
#include "integrators/vertex.h"
#include "scene/scene.h"

namespace rayleaf {

class DenoisingFeatures {
  public:
    /// The path's next surface, `length` along its ray. Writes the passes Denoising Normal, Albedo and Depth.
    void meet(const Scene& scene, const Vertex& vertex, double length, PixelSample& sample);
    /// A medium that scatters, of this albedo: nothing beyond is seen clearly.
    void meet_medium(const Color& albedo, PixelSample& sample);
    /// Light that the path meets where it ends.
    void meet_light(const Color& radiance, PixelSample& sample);
    /// Follows one of several rays, which has this share of the surface.
    void take_share(float share) { share_ *= share; }

  private:
    Color passed_{1, 1, 1};  ///< what mirrors and glass on the way leave of a colour
    float share_ = 1;        ///< of the camera sample
    bool is_done_ = false;

    void end(const Vec3f& normal, PixelSample& sample);
};

}  // namespace rayleaf
