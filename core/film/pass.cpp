#include "film/pass.h"

namespace rayleaf {

std::optional<Pass> find_pass(std::string_view name) {
    for (const PassInfo& entry : kPasses)
        if (entry.identifier == name || entry.name == name) return entry.pass;
    return std::nullopt;
}

}  // namespace rayleaf
