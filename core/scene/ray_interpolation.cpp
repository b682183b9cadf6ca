#include "scene/ray_interpolation.h"

namespace rayleaf {

RayCacheSettings thresholds_for(double error) {
    return quality_settings(error);
}

void validate(const std::string& object, const RayInterpolation& interpolation) {
    checked(object, interpolation.thresholds);
}

}  // namespace rayleaf
