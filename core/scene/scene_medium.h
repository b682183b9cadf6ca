// A medium in its place: what fills an object, or the world.
#pragma once

#include "scene/majorant_grid.h"
#include "shading/program.h"

#include <memory>

namespace rayleaf {

struct SceneMedium {
    static constexpr uint32_t kWorld = ~0u;

    uint32_t instance = kWorld;
    const Program* program = nullptr;
    std::unique_ptr<const MajorantGrid> grid = nullptr;  ///< of one that varies from place to place, in object space
};

}  // namespace rayleaf
