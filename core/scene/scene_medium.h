// A medium in its place: what fills an object, or the world.
#pragma once

#include "geometry/volume_grids.h"
#include "scene/majorant_grid.h"
#include "shading/program.h"

#include <memory>
#include <optional>

namespace rayleaf {

/// What a medium does that does it everywhere.
struct EvenMedium {
    MediumClosures medium;
    Color emission{0, 0, 0};
};

struct SceneMedium {
    static constexpr uint32_t kWorld = ~0u;

    uint32_t instance = kWorld;
    const Program* program = nullptr;
    float material_index = 0;
    std::unique_ptr<const MajorantGrid> grid = nullptr;  ///< of one that varies from place to place, in object space
    std::optional<EvenMedium> even = std::nullopt;       ///< where its program need not run
    const VolumeGrids* voxels = nullptr;                 ///< outside of what they hold there is nothing; null: none
    float density_factor = 1;                            ///< on extinction and scattering: world units for the object's
    float glow_rate = 0;  ///< lookups per world unit where it emits at least, as if its extinction were as much
};

}  // namespace rayleaf
