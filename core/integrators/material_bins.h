// The paths of a stream by the program of the surface that they met, so that each program runs once for many of them.
#pragma once

#include "shading/program.h"

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace rayleaf {

class MaterialBins {
  public:
    void clear();
    void add(const Program& program, uint32_t path);
    /// Calls `visit(program, paths)` for each program that was met. Paths keep their order.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for (size_t i = 0; i < used_; ++i) visit(*bins_[i].program, std::span<const uint32_t>(bins_[i].paths));
    }

  private:
    struct Bin {
        const Program* program;
        std::vector<uint32_t> paths;
    };
    std::vector<Bin> bins_;  ///< the first `used_` of them; the others keep their memory
    size_t used_ = 0;
    size_t last_ = 0;  ///< bin of the path before: neighbours often meet the same
    std::unordered_map<const Program*, size_t> bin_of_;
};

}  // namespace rayleaf
