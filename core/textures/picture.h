// Pixels in memory, on their way from a file or from Blender to a texture.
#pragma once

#include "base/cancel.h"
#include "textures/texture_store.h"

#include <vector>

namespace rayleaf {

/// Whether the pixels that come in have been multiplied by their alpha, and whether they ever are.
enum class Alpha : uint8_t { Straight, Associated, Separate };

/// Rows top to bottom, straight or associated as they came.
struct Picture {
    std::vector<uint8_t> bytes;  ///< of a picture that came as bytes: what its pixels are made from by `prepare`
    std::vector<float> pixels;
    int width = 0, height = 0, channels = 0;
    Alpha alpha = Alpha::Straight;
    bool precise = false;           ///< wants more than half floats
    std::vector<uint8_t> prepared;  ///< rows that `prepare` has done

    int alpha_channel() const { return channels == 4 ? 3 : -1; }
    /// Numbers in a row, and in all.
    size_t row() const { return static_cast<size_t>(width) * static_cast<size_t>(channels); }
    size_t count() const { return row() * static_cast<size_t>(height); }
};

/// What a byte of a picture stands for, from 0 to 1.
inline float from_byte(uint8_t byte) {
    return static_cast<float>(byte) * (1.0f / 255.0f);
}

/// Lengthens an array with zeros, part by part: of a large picture they take longer than a cancelled render may.
void make_room(std::vector<float>& pixels, size_t count, const CancelToken& cancel);

/// Coding of sRGB (IEC 61966-2-1).
float decoded_srgb(float x);
float encoded_srgb(float x);

/// Gives it one, three or four channels: grey and alpha become colours with alpha, what is beyond four is left out, and
/// alpha where it is ignored.
void normalize_channels(Picture& picture, ImageAlpha alpha);
/// Makes it what textures are filtered from: finite numbers, linear light with associated alpha. Data images keep their
/// channels as they are, and so do colours beside a separate alpha, which become linear. Throws Cancelled soon after
/// `cancel` says so; the next call does the rest.
void prepare(Picture& picture, const ImageColors& colors, const CancelToken& cancel);

}  // namespace rayleaf
