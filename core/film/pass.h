// The passes a film can hold: film/passes.def as an enum and a table.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace rayleaf {

enum class Pass {
#define PASS(identifier, name, channels, property, meaning) identifier,
#include "film/passes.def"
#undef PASS
};

struct PassInfo {
    Pass pass;
    std::string_view identifier;
    std::string_view name;      ///< Blender's
    std::string_view channels;  ///< one letter each
    std::string_view property;
};

inline constexpr std::array kPasses = {
#define PASS(identifier, name, channels, property, meaning) \
    PassInfo{Pass::identifier, #identifier, name, channels, property},
#include "film/passes.def"
#undef PASS
};
inline constexpr size_t kPassCount = kPasses.size();

/// The pass of that identifier or Blender name.
std::optional<Pass> find_pass(std::string_view name);

inline const PassInfo& info(Pass pass) {
    return kPasses[static_cast<size_t>(pass)];
}

}  // namespace rayleaf
