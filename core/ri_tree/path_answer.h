// What a scene of several objects makes of a ray: the answer of the rivals in benchmarks and of sets of ray caches.
#pragma once

#include "ri_tree/ray_cache.h"

#include <cstdint>

namespace rayleaf {

inline constexpr int32_t kNoObject = -1;

/// Object space, which is the same for all objects of a set; single precision.
struct PathAnswer {
    int32_t object = kNoObject;  ///< the one hit first
    AnsweredBy by = AnsweredBy::NotARay;
    Vec3f position{0, 0, 0}, normal{0, 0, 0};               ///< first hit; zero for volumes
    Vec3f exit_position{0, 0, 0}, exit_direction{0, 0, 0};  ///< as in OutputRay; no direction if none leaves
    float length = 0;                                       ///< volumes: inside all objects together
};

}  // namespace rayleaf
