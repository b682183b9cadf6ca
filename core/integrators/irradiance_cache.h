// Hemispheres sampled at few points and interpolated between (G. Ward, F. Rubinstein, R. Clear, A Ray Tracing Solution
// for Diffuse Interreflection, 1988; with the gradients of Ward and Heckbert 1992).
//
// A record may answer for a point where the error it foresees, distance over radius plus the root of one less the
// cosine between the normals, is below the error allowed. Those that may are weighted by how far they are below it, so
// that none comes or goes with a step. Filled before the frame (integrators/irradiance_fill.h), only read within it.
#pragma once

#include "integrators/hemisphere_record.h"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace rayleaf {

class IrradianceCache {
  public:
    /// `error` is the error allowed, 0..1.
    explicit IrradianceCache(float error) : error_(error) {}

    /// In an order that does not depend on threads: it shows in the last bits of what is interpolated.
    void insert(const HemisphereRecord& record);
    /// Irradiance at a point of a surface with unit `normal`; empty where no record may answer.
    std::optional<HemisphereLight> interpolate(const Vec3d& position, const Vec3f& normal) const;
    size_t size() const { return records_.size(); }
    size_t bytes() const;

  private:
    /// Records by the cells they may answer for, whose side is 2^exponent, at least their reach twice.
    struct Level {
        int exponent = 0;
        std::unordered_map<uint64_t, std::vector<uint32_t>> cells;  ///< by a hash of the cell: some share a list
    };
    float error_;
    std::vector<HemisphereRecord> records_;
    std::vector<Level> levels_;  ///< by exponent, ascending

    Level& level(int exponent);
    /// Weight of a record at a point; 0 where it may not answer.
    float weight(const HemisphereRecord& record, const Vec3d& position, const Vec3f& normal) const;
};

}  // namespace rayleaf
