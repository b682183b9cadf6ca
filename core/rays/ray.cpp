#include "rays/ray.h"

namespace rayleaf {

RaySight::RaySight(const RaySight& other) = default;
RaySight& RaySight::operator=(const RaySight& other) = default;

}  // namespace rayleaf
