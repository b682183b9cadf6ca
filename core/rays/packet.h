// Rays that are traced together.
#pragma once

namespace rayleaf {

/// Rays in a packet: Embree's largest, and the lanes of the widest vector.
inline constexpr int kPacketSize = 16;

/// Whether the rays of a packet have similar origins and directions: those of a camera do, bounces do not.
enum class Coherence : unsigned char { Coherent, Incoherent };

}  // namespace rayleaf
