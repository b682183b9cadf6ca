// What a description takes: each of these throws InputError, which names the object, for anything else.
#pragma once

#include "scene/description.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace rayleaf {

/// An index from `least` to below `count`.
void check_index(const std::string& object, const char* argument, int index, size_t count, int least);
/// Rejects what is no slot of a film, and not -1.
void check_light_group(const std::string& object, int slot);
/// Rejects maps that are not finite or that flatten space so far that its normals have no direction.
void check_matrix(const std::string& object, const Affine3d& m);
/// The motion through at least two finite places at even steps of the shutter's time; null where all are the same. They
/// may be flat: then nothing is seen of the instance.
std::shared_ptr<const Motion> checked_motion(const std::string& object, std::span<const Affine3d> places);
/// Also fills in what follows from the rest: `bounds_medium_alone`.
Material checked_material(Material material);

}  // namespace rayleaf
