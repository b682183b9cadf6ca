// The passes a film can hold: film/passes.def as an enum and a table; and numbered passes (slots and mattes).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace rayleaf {

enum class Pass : uint16_t {
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

/// Slots are passes of which a scene names as many as it likes: AOVs, which programs write, and light groups. Their
/// identifiers are slot0, slot1, ...
inline constexpr size_t kMostSlots = 64;
constexpr Pass slot_pass(size_t slot) {
    return static_cast<Pass>(kPassCount + slot);
}

/// Mattes: Cryptomatte's passes, each with two ranks of ids and their shares of the pixel (film/mattes.h).
enum class MatteKind : uint8_t { Object, Material, Asset };
inline constexpr size_t kMatteKinds = 3, kMostMattePairs = 8, kFirstMatte = kPassCount + kMostSlots;
constexpr Pass matte_pass(MatteKind kind, size_t pair) {
    return static_cast<Pass>(kFirstMatte + static_cast<size_t>(kind) * kMostMattePairs + pair);
}

inline constexpr size_t kAllPasses = kFirstMatte + kMatteKinds * kMostMattePairs;
constexpr bool is_slot(Pass pass) {
    return static_cast<size_t>(pass) >= kPassCount && static_cast<size_t>(pass) < kFirstMatte;
}
constexpr bool is_matte(Pass pass) {
    return static_cast<size_t>(pass) >= kFirstMatte;
}
constexpr size_t slot_of(Pass pass) {
    return static_cast<size_t>(pass) - kPassCount;
}

/// One value for each pass but mattes; slots have room once they are asked for.
template <typename Value>
class PerPass {
  public:
    Value& operator[](Pass pass) {
        if (!is_slot(pass)) return of_table_[static_cast<size_t>(pass)];
        if (of_slots_.size() <= slot_of(pass)) of_slots_.resize(slot_of(pass) + 1);
        return of_slots_[slot_of(pass)];
    }
    /// The pass must have been written already.
    const Value& operator[](Pass pass) const {
        return is_slot(pass) ? of_slots_[slot_of(pass)] : of_table_[static_cast<size_t>(pass)];
    }

  private:
    std::array<Value, kPassCount> of_table_;
    std::vector<Value> of_slots_;
};

/// The pass of that identifier or Blender name.
std::optional<Pass> find_pass(std::string_view name);

/// The info of slots and mattes, which the table does not list.
const PassInfo& info_beside_table(Pass pass);

inline const PassInfo& info(Pass pass) {
    return static_cast<size_t>(pass) < kPassCount ? kPasses[static_cast<size_t>(pass)] : info_beside_table(pass);
}

}  // namespace rayleaf
