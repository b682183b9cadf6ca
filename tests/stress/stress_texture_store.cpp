// Textures whose tiles do not fit the memory allowed, looked up by many threads while other stores come and go: the
// colours are those that one thread finds. Stores share what is converted, and leave while it is.
#include "base/error.h"
#include "stress.h"
#include "textures/converted_textures.h"
#include "textures/texture_store.h"

using namespace rayleaf;

namespace {

constexpr int kSide = 1024, kTextures = 3;
constexpr size_t kLeastMemory = size_t{10} << 20;

std::vector<float> picture(int side, float shift) {
    std::vector<float> pixels;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const auto wave = [&](int i) {
                return 0.5f + 0.5f * std::sin(shift + static_cast<float>(i * x + y) * 0.01f);
            };
            pixels.insert(pixels.end(), {wave(1), wave(2), wave(3), 1.0f});
        }
    return pixels;
}

/// Colours at places that a number tells.
std::vector<Vec4f> colours(const TextureStore& store, int number, int count) {
    std::mt19937 random(static_cast<uint32_t>(number));
    std::uniform_real_distribution<float> even(0.0f, 1.0f);
    std::vector<Vec4f> found;
    for (int i = 0; i < count; ++i) {
        const Vec2f uv(even(random), even(random));
        const float width = std::exp2(-12.0f * even(random));
        found.push_back(store.lookup(static_cast<TextureId>(random() % kTextures), uv, {width, 0}, {0, width},
                                     TextureExtension::Repeat, {TextureInterpolation::Linear}));
    }
    return found;
}

/// A bitmap of 4 x 4 pixels, of which there are none.
constexpr uint8_t kTorn[54] = {'B', 'M', 102, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40,
                               0,   0,   0,   4, 0, 0, 0, 4, 0, 0, 0,  1, 0, 24};

/// Stores that share what is converted: most are gone, or have been cancelled, while another thread still converts for
/// them.
void share_conversions(const std::shared_ptr<ConvertedTextures>& converted, int thread) {
    constexpr int kSmall = 48, kImages = 6;
    for (int round = 0; round < 4; ++round) {
        TextureStore store(kLeastMemory, converted);
        for (int i = 0; i < kImages; ++i) {
            const auto shift = static_cast<float>((thread + round + i) % 7);
            store.add_pixels("shared", picture(kSmall, shift), kSmall, kSmall, 4, ColorSpace::Srgb);
        }
        store.add_packed("torn", std::as_bytes(std::span(kTorn)), ColorSpace::Srgb);
        if (round == 3) stress::require(store.leave_out_unreadable({}).size() == 1, "an image that nobody can read");
        CancelToken cancel;
        if (round == 1) cancel.cancel();
        if (round == 2) continue;
        try {
            store.finish(cancel);
        } catch (const Cancelled&) {
            continue;
        } catch (const InputError&) {
            stress::require(round == 0, "an image refused that was left out");
            continue;
        }
        const Vec4f found =
            store.lookup(0, {0.5f, 0.5f}, {0, 0}, {0, 0}, TextureExtension::Repeat, {TextureInterpolation::Closest});
        stress::require(found[3] == 1.0f, "an image that is not converted");
    }
}

/// The thread that has asked for conversions is gone before the store is, and no other thread would run them.
void outlive_the_thread_that_asked() {
    auto store = std::make_unique<TextureStore>(kLeastMemory);
    stress::run_together(1, [&](int) { store->add_pixels("left", picture(48, 0.0f), 48, 48, 4, ColorSpace::Srgb); });
    store.reset();
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    outlive_the_thread_that_asked();
    TextureStore store(kLeastMemory);
    for (int i = 0; i < kTextures; ++i)
        store.add_pixels("wave", picture(kSide, static_cast<float>(i)), kSide, kSide, 4, ColorSpace::Linear);
    constexpr int kNumbers = 8, kLookups = 400;
    std::vector<std::vector<Vec4f>> wanted;
    for (int number = 0; number < kNumbers; ++number) wanted.push_back(colours(store, number, kLookups));
    const size_t before = store.statistics().file_reads;
    const auto converted = std::make_shared<ConvertedTextures>();
    for (const int threads : stress::kThreadCounts)
        stress::run_together(threads, [&](int thread) {
            if (thread % 16 == 1) {
                TextureStore other(kLeastMemory);
                other.add_pixels("other", picture(16, 0.0f), 16, 16, 4, ColorSpace::Linear);
                other.lookup(0, {0.5f, 0.5f}, {0, 0}, {0, 0}, TextureExtension::Clip, {TextureInterpolation::Cubic});
            }
            if (thread % 4 == 3) share_conversions(converted, thread);
            stress::require(
                colours(store, thread % kNumbers, kLookups) == wanted[static_cast<size_t>(thread % kNumbers)],
                "another colour");
        });
    stress::require(store.statistics().file_reads > before + 100, "all tiles fitted");
}
