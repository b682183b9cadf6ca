#include "film/mattes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

namespace rayleaf {
namespace {

uint32_t mixed(uint32_t block) {
    return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u;
}

/// Up to four bytes, the least significant first.
uint32_t block_of(std::string_view bytes) {
    uint32_t block = 0;
    for (size_t i = bytes.size(); i-- > 0;) block = block << 8 | static_cast<uint8_t>(bytes[i]);
    return block;
}

/// As it stands between quotes in JSON.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (static_cast<uint8_t>(c) < 0x20) {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
            result += code;
            continue;
        }
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    result += '"';
    return result;
}

}  // namespace

uint32_t matte_hash(std::string_view name) {
    constexpr size_t kBlock = 4;
    uint32_t hash = 0;
    size_t at = 0;
    for (; at + kBlock <= name.size(); at += kBlock)
        hash = std::rotl(hash ^ mixed(block_of(name.substr(at, kBlock))), 13) * 5u + 0xe6546b64u;
    if (at < name.size()) hash ^= mixed(block_of(name.substr(at)));
    hash ^= static_cast<uint32_t>(name.size());
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return hash ^ hash >> 16;
}

uint32_t matte_id(uint32_t hash) {
    constexpr uint32_t kExponentShift = 23, kMostExponent = 254;
    const uint32_t exponent = hash >> kExponentShift & 0xffu;
    const uint32_t normal = std::clamp(exponent, 1u, kMostExponent);
    return (hash & ~(0xffu << kExponentShift)) | normal << kExponentShift;
}

std::string matte_manifest(std::vector<std::string> names) {
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    std::string text = "{";
    for (const std::string& name : names) {
        char hash[12];
        std::snprintf(hash, sizeof hash, "\"%08x\"", matte_hash(name));
        if (text.size() > 1) text += ',';
        text.append(quoted(name)).append(":").append(hash);
    }
    text += '}';
    return text;
}

std::map<std::string, std::string> matte_attributes(const std::string& layer, const std::string& manifest) {
    constexpr size_t kKeyLength = 7;
    char hash[12];
    std::snprintf(hash, sizeof hash, "%08x", matte_hash(layer));
    const std::string prefix = std::string("cryptomatte/").append(hash, kKeyLength).append("/");
    return {{prefix + "name", layer},
            {prefix + "hash", "MurmurHash3_32"},
            {prefix + "conversion", "uint32_to_float32"},
            {prefix + "manifest", manifest}};
}

uint32_t matte_weight(float share) {
    if (!(share > 0.0f)) return 0;
    return static_cast<uint32_t>(std::lround(static_cast<double>(std::min(share, kMostMatteShare)) / kMatteUnit));
}

void MatteSums::add(uint32_t id, uint64_t weight) {
    if (weight == 0) return;
    for (Entry& entry : entries_)
        if (entry.id == id) {
            entry.weight += weight;
            return;
        }
    entries_.push_back({weight, id});
}

std::vector<MatteSums::Entry> MatteSums::ranked() const {
    std::vector<Entry> ranked = entries_;
    std::sort(ranked.begin(), ranked.end(),
              [](const Entry& a, const Entry& b) { return a.weight != b.weight ? a.weight > b.weight : a.id < b.id; });
    return ranked;
}

Mattes::Mattes(int width, int height, std::span<const Pass> passes) : width_(width) {
    samples_.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 0);
    for (const Pass pass : passes)
        if (is_matte(pass)) pixels_[static_cast<size_t>(matte_kind(pass))].resize(samples_.size());
}

void Mattes::add(int x, int y, int samples, const PixelMattes& found) {
    samples_[pixel(x, y)] += samples;
    for (size_t kind = 0; kind < kMatteKinds; ++kind) {
        if (pixels_[kind].empty()) continue;
        MatteSums& sums = pixels_[kind][pixel(x, y)];
        for (const MatteSums::Entry& entry : found[kind].entries()) sums.add(entry.id, entry.weight);
    }
}

std::vector<float> Mattes::pixels(Pass matte) const {
    const std::vector<MatteSums>& sums = pixels_[static_cast<size_t>(matte_kind(matte))];
    std::vector<float> pixels(sums.size() * 4, 0.0f);
    for (size_t i = 0; i < sums.size(); ++i) {
        const std::vector<MatteSums::Entry> ranked = sums[i].ranked();
        for (size_t rank = 0; rank < 2; ++rank) {
            const size_t place = 2 * matte_pair(matte) + rank;
            if (place >= ranked.size()) break;
            pixels[4 * i + 2 * rank] = std::bit_cast<float>(ranked[place].id);
            pixels[4 * i + 2 * rank + 1] =
                static_cast<float>(static_cast<double>(ranked[place].weight) * kMatteUnit / std::max(samples_[i], 1));
        }
    }
    return pixels;
}

size_t Mattes::bytes() const {
    size_t bytes = samples_.size() * sizeof(int);
    for (const std::vector<MatteSums>& sums : pixels_)
        for (const MatteSums& each : sums)
            bytes += sizeof(MatteSums) + each.entries().size() * sizeof(MatteSums::Entry);
    return bytes;
}

std::unique_ptr<Mattes> mattes_for(int width, int height, std::span<const Pass> passes) {
    return std::any_of(passes.begin(), passes.end(), is_matte) ? std::make_unique<Mattes>(width, height, passes)
                                                               : nullptr;
}

std::vector<Pass> without_mattes(std::span<const Pass> passes) {
    std::vector<Pass> others;
    std::copy_if(passes.begin(), passes.end(), std::back_inserter(others), [](Pass pass) { return !is_matte(pass); });
    return others;
}

}  // namespace rayleaf
