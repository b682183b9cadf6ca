#include "film/pass.h"

#include <string>

namespace rayleaf {
namespace {

constexpr std::array<const char*, kMatteKinds> kMatteIdentifiers = {"crypto_object_0", "crypto_material_0",
                                                                    "crypto_asset_0"};
constexpr std::array<const char*, kMatteKinds> kMatteNames = {"CryptoObject0", "CryptoMaterial0", "CryptoAsset0"};

/// What slots and mattes are called.
struct NumberedPasses {
    std::array<std::string, kAllPasses - kPassCount> identifiers, names;
    std::array<PassInfo, kAllPasses - kPassCount> infos;

    NumberedPasses() {
        for (size_t slot = 0; slot < kMostSlots; ++slot)
            set(slot_pass(slot), joined("slot", slot), joined("Slot ", slot), "RGBA");
        for (size_t kind = 0; kind < kMatteKinds; ++kind)
            for (size_t pair = 0; pair < kMostMattePairs; ++pair)
                set(matte_pass(static_cast<MatteKind>(kind), pair), joined(kMatteIdentifiers[kind], pair),
                    joined(kMatteNames[kind], pair), "rgba");
    }
    static std::string joined(std::string text, size_t number) { return text.append(std::to_string(number)); }
    void set(Pass pass, const std::string& identifier, const std::string& name, std::string_view channels) {
        const size_t i = static_cast<size_t>(pass) - kPassCount;
        identifiers[i] = identifier;
        names[i] = name;
        infos[i] = {pass, identifiers[i], names[i], channels, {}};
    }
};

const NumberedPasses& numbered() {
    static const NumberedPasses passes;
    return passes;
}

}  // namespace

const PassInfo& info_beside_table(Pass pass) {
    return numbered().infos[static_cast<size_t>(pass) - kPassCount];
}

std::optional<Pass> find_pass(std::string_view name) {
    for (const PassInfo& entry : kPasses)
        if (entry.identifier == name || entry.name == name) return entry.pass;
    for (const PassInfo& entry : numbered().infos)
        if (entry.identifier == name) return entry.pass;
    return std::nullopt;
}

}  // namespace rayleaf
