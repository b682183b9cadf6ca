// A 128-bit hash of content, by which equal data is recognized. Not cryptographic: nobody is assumed to construct
// collisions.
#pragma once

#include "base/vector.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace rayleaf {

using ContentHash = std::array<uint64_t, 2>;

class ContentHasher {
  public:
    void add(uint64_t word) {
        // The mixer of SplitMix64 (Steele, Lea, Flood 2014), in two lanes that start apart and see different words.
        lanes_[0] = mixed(lanes_[0] + kGolden + word);
        lanes_[1] = mixed((lanes_[1] ^ std::rotl(word, 32)) + kOther);
    }
    void add(double number) { add(std::bit_cast<uint64_t>(number)); }
    void add(int number) { add(static_cast<uint64_t>(static_cast<uint32_t>(number))); }
    void add(uint32_t number) { add(uint64_t{number}); }
    void add(const Affine3d& map) {
        for (const Vec3d& column : {map.x, map.y, map.z, map.translation})
            for (int axis = 0; axis < 3; ++axis) add(column[axis]);
    }
    /// Adds the bytes of numbers without padding.
    template <typename T>
    void add(const std::vector<T>& values) {
        add(std::span<const T>(values));
    }
    template <typename T>
    void add(std::span<const T> values) {
        static_assert(std::is_trivially_destructible_v<T>);
        add(static_cast<uint64_t>(values.size()));
        add_bytes({reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T)});
    }
    ContentHash value() const { return lanes_; }

  private:
    static constexpr uint64_t kGolden = 0x9e3779b97f4a7c15, kOther = 0xd1b54a32d192ed03;
    static constexpr size_t kWays = 4;
    ContentHash lanes_{0x243f6a8885a308d3, 0x13198a2e03707344};  // digits of pi

    static uint64_t mixed(uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
        x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
        return x ^ (x >> 31);
    }
    static uint64_t word_at(std::span<const unsigned char> bytes, size_t word) {
        uint64_t result;
        std::memcpy(&result, bytes.data() + word * sizeof result, sizeof result);
        return result;
    }
    void add_bytes(std::span<const unsigned char> bytes) {
        const size_t words = bytes.size() / sizeof(uint64_t), whole = words / kWays * kWays;
        if (whole > 0) {  // in several ways at once, which need not wait for each other
            std::array<ContentHasher, kWays> ways;
            for (size_t i = 0; i < whole; i += kWays)
                for (size_t way = 0; way < kWays; ++way) ways[way].add(word_at(bytes, i + way));
            for (const ContentHasher& way : ways)
                for (const uint64_t lane : way.lanes_) add(lane);
        }
        for (size_t i = whole; i < words; ++i) add(word_at(bytes, i));
        if (const size_t rest = bytes.size() % sizeof(uint64_t); rest > 0) {
            uint64_t word = 0;
            std::memcpy(&word, bytes.data() + words * sizeof word, rest);
            add(word);
        }
    }
};

}  // namespace rayleaf
