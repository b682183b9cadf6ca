// Embree's scenes that are built within tasks outlive them. Tasks that fail later end alone: the scenes neither crash
// them nor are cancelled with them.
#include "base/cancel.h"
#include "geometry/triangle_mesh.h"
#include "stress.h"
#include "trace/triangle_scene.h"

#include <array>
#include <atomic>

#include <oneapi/tbb/parallel_for.h>

using namespace rayleaf;

namespace {

constexpr size_t kScenes = 64;

std::shared_ptr<const TriangleMesh> triangle() {
    constexpr float vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    constexpr int32_t corners[] = {0, 1, 2};
    TriangleMeshArrays arrays;
    arrays.name = "triangle";
    arrays.vertices = vertices;
    arrays.triangles = corners;
    return std::make_shared<TriangleMesh>(std::move(arrays));
}

constexpr size_t kFrame = 4096, kDepth = 16;

/// Far down on the stack.
[[gnu::noinline]] void build_deep(const TriangleMesh& mesh, std::vector<std::unique_ptr<TriangleScene>>& scenes,
                                  size_t depth = kDepth) {
    std::array<volatile unsigned char, kFrame> frame;
    frame.front() = 0;
    if (depth > 0)
        build_deep(mesh, scenes, depth - 1);
    else
        oneapi::tbb::parallel_for(size_t{0}, scenes.size(), [&](size_t i) {
            scenes[i] = std::make_unique<TriangleScene>(mesh, kNeverCancelled);
        });
    frame.back() = 0;
}

/// What the builds left on the stack becomes addresses where nothing is.
[[gnu::noinline]] void write_over_stack() {
    std::array<volatile unsigned char, 2 * kFrame * kDepth> frame;
    for (volatile unsigned char& byte : frame) byte = 0xab;
}

/// Tasks of tasks, of which one fails.
void fail() {
    try {
        oneapi::tbb::parallel_for(0, 8, [](int) {
            std::atomic<int> count{0};
            oneapi::tbb::parallel_for(0, 8, [&](int) { ++count; });
            throw Cancelled();
        });
    } catch (const Cancelled&) {
        return;
    }
    stress::require(false, "the tasks' exception is lost");
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    const std::shared_ptr<const TriangleMesh> mesh = triangle();
    for (int round = 0; round < 20; ++round) {
        std::vector<std::unique_ptr<TriangleScene>> scenes(kScenes);
        build_deep(*mesh, scenes);
        write_over_stack();
        fail();
    }
}
