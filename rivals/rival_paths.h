// Output rays by the rival tracers (rival_scene.h): the same paths as SampleTracer's, in single precision.
#pragma once

#include "ri_tree/path_answer.h"
#include "rivals/counting_scene.h"
#include "rivals/rival_scene.h"

#include <span>
#include <vector>

namespace rayleaf {

struct RivalMaterial {
    OutputKind kind = OutputKind::Mirror;
    float ior = 1.45f;
    int most_interior_hits = kMostInteriorHits;  ///< as SampleSettings has it
};

/// A path under way, scene space.
struct RivalPath {
    RivalRay ray;
    PathAnswer answer;
    int hits = 0;
    int inside = 0;     ///< volumes: bodies around the ray
    float entered = 0;  ///< volumes: where
};

/// Distance from a surface at which rays continue, scene units.
inline constexpr float kRivalStartOffset = 0x1p-15f;
/// Distance behind a crossing at which a line continues, scene units: the error of the distance at grazing hits.
inline constexpr float kRivalCrossingStep = 0x1p-11f;
/// Operations of one reflection or refraction, all included.
inline constexpr int kBounceFlops = 45;

/// Advances a path by a hit or a miss (null); returns whether it continues with `path.ray`.
bool advance(RivalPath& path, const RivalHit* hit, std::span<const RivalMaterial> materials);

enum class PacketUse : uint8_t { SingleRays, Packets };

class RivalTracer {
  public:
    /// A material for each surface.
    RivalTracer(std::span<const std::shared_ptr<const PatchSurface>> surfaces, std::vector<RivalMaterial> materials,
                RivalMethod method);

    /// Rays in object space, finite, of unit length. Packets are made of rays that follow one another.
    void trace(std::span<const Ray> rays, std::span<PathAnswer> answers, PacketUse packets) const;
    const RivalScene& scene() const { return scene_; }
    /// The floating-point operations that each ray takes (counting_scene.h), asked of the scene's twin.
    void count(const CountingScene& twin, std::span<const Ray> rays, std::span<uint64_t> flops) const;

  private:
    RivalScene scene_;
    std::vector<RivalMaterial> materials_;

    RivalPath path_of(const Ray& ray) const;
    PathAnswer in_object_space(const PathAnswer& answer) const;
    void trace_packet(std::span<const Ray> rays, std::span<PathAnswer> answers) const;
};

}  // namespace rayleaf
