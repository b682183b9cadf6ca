// Cryptomatte: which objects, materials and assets a pixel shows, and how much of each (Friedman and Jones 2015,
// "Fully automatic ID mattes with support for motion blur and transparency").
//
// Shares are summed as whole numbers, so that neither the order of samples nor how they were divided among threads,
// tiles and machines changes a bit. All ids of a pixel are kept; passes show those with the largest shares.
#pragma once

#include "film/pass.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rayleaf {

/// MurmurHash3 (Appleby), 32 bits, seed 0: how Cryptomatte hashes names.
uint32_t matte_hash(std::string_view name);
/// The bits of the float that stands for a hash: neither zero nor an infinity, a NaN or denormal.
uint32_t matte_id(uint32_t hash);
/// JSON: each name with its hash.
std::string matte_manifest(std::vector<std::string> names);

/// What the passes of a kind are called, without their numbers.
inline constexpr std::array<std::pair<MatteKind, const char*>, kMatteKinds> kMatteLayers = {
    {{MatteKind::Object, "CryptoObject"}, {MatteKind::Material, "CryptoMaterial"}, {MatteKind::Asset, "CryptoAsset"}}};

/// What a file's header says of a kind's passes: names of attributes and their texts.
std::map<std::string, std::string> matte_attributes(const std::string& layer, const std::string& manifest);

/// One surface that a camera sample sees.
struct MatteRecord {
    std::array<uint32_t, kMatteKinds> ids{};
    uint32_t weight = 0;  ///< its share of the sample, in units of kMatteUnit
};
inline constexpr double kMatteUnit = 0x1p-24;
/// A share as such a number; what is brighter than white counts at most kMostMatteShare.
inline constexpr float kMostMatteShare = 64.0f;
uint32_t matte_weight(float share);

/// The ids of one kind in one pixel.
class MatteSums {
  public:
    struct Entry {
        uint64_t weight = 0;
        uint32_t id = 0;
    };

    void add(uint32_t id, uint64_t weight);
    /// In the order in which they came.
    std::span<const Entry> entries() const { return entries_; }
    /// The largest shares first; equal ones by id.
    std::vector<Entry> ranked() const;

  private:
    std::vector<Entry> entries_;
};
using PixelMattes = std::array<MatteSums, kMatteKinds>;

/// Those of all pixels.
class Mattes {
  public:
    Mattes(int width, int height, std::span<const Pass> passes);

    bool has(MatteKind kind) const { return !pixels_[static_cast<size_t>(kind)].empty(); }
    /// Samples of one pixel.
    void add(int x, int y, int samples, const PixelMattes& found);
    const MatteSums& at(MatteKind kind, int x, int y) const { return pixels_[static_cast<size_t>(kind)][pixel(x, y)]; }
    /// Id and share of two ranks, channels interleaved.
    std::vector<float> pixels(Pass matte) const;
    size_t bytes() const;

  private:
    int width_;
    std::vector<int> samples_;                                ///< of each pixel
    std::array<std::vector<MatteSums>, kMatteKinds> pixels_;  ///< of the kinds that are asked for

    size_t pixel(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
    }
};

/// Null where no pass is a matte.
std::unique_ptr<Mattes> mattes_for(int width, int height, std::span<const Pass> passes);
inline MatteKind matte_kind(Pass matte) {
    return static_cast<MatteKind>((static_cast<size_t>(matte) - kFirstMatte) / kMostMattePairs);
}
inline size_t matte_pair(Pass matte) {
    return (static_cast<size_t>(matte) - kFirstMatte) % kMostMattePairs;
}
/// Those that are no mattes.
std::vector<Pass> without_mattes(std::span<const Pass> passes);

}  // namespace rayleaf
