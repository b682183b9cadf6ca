#include "lights/light_linking.h"

#include "base/error.h"

namespace rayleaf {
namespace {

void check_set(const std::string& owner, const char* argument, int64_t number, int64_t least, int64_t most) {
    if (number < least || number > most)
        throw InputError(owner, argument, std::to_string(number),
                         std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

LightSets checked_light_sets(const std::string& owner, int64_t lit_by) {
    check_set(owner, "light sets", lit_by, 0, kAnyLight);
    return static_cast<LightSets>(lit_by) | kLightsOfAll;
}

LightLink checked_light_link(const std::string& owner, int64_t receivers, int64_t blockers) {
    check_set(owner, "receivers", receivers, -1, kReceiverSets - 1);
    check_set(owner, "blockers", blockers, -1, kBlockerSets - 1);
    return {static_cast<int8_t>(receivers), static_cast<int8_t>(blockers)};
}

LightLinking checked_light_linking(const std::string& owner, const std::array<int64_t, 4>& numbers) {
    check_set(owner, "blocker sets", numbers[1], 0, int64_t{kAllBlockerSets});
    return {checked_light_sets(owner, numbers[0]), static_cast<uint32_t>(numbers[1]),
            checked_light_link(owner, numbers[2], numbers[3])};
}

}  // namespace rayleaf
