// The samples of the published tree: attributes and class, counted by reference: the cells that meet in a corner share
// its sample.
#pragma once

#include "ri_tree/output_ray.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

using SampleId = uint32_t;

class SamplePool {
  public:
    explicit SamplePool(OutputKind kind) : kind_(kind), stride_(static_cast<size_t>(attribute_count(kind))) {}

    /// Adds a sample with one holder.
    SampleId add(const OutputRay& ray) {
        if (free_.empty()) grow();
        const SampleId id = free_.back();
        free_.pop_back();
        Block& block = block_of(id);
        store_attributes(kind_, ray, {block.attributes.data() + (id % kBlockSize) * stride_, stride_});
        block.classes[id % kBlockSize] = ray.sample_class;
        block.holders[id % kBlockSize] = 1;
        ++count_;
        return id;
    }
    void hold(SampleId id) { ++block_of(id).holders[id % kBlockSize]; }
    void let_go(SampleId id) {
        if (--block_of(id).holders[id % kBlockSize] > 0) return;
        free_.push_back(id);
        --count_;
    }

    const SampleClass& sample_class(SampleId id) const { return block_of(id).classes[id % kBlockSize]; }
    std::span<const float> attributes(SampleId id) const {
        return {block_of(id).attributes.data() + (id % kBlockSize) * stride_, stride_};
    }

    size_t count() const { return count_; }
    size_t bytes_per_sample() const {
        return stride_ * sizeof(float) + sizeof(SampleClass) + sizeof(uint32_t) + sizeof(SampleId);
    }
    /// Of the samples held now; the memory of freed ones is used again.
    size_t bytes() const { return count_ * bytes_per_sample(); }
    /// Frees all memory; no sample may be held any more.
    void clear() {
        blocks_.clear();
        free_.clear();
        count_ = 0;
    }

  private:
    static constexpr SampleId kBlockSize = 1024;
    struct Block {
        std::vector<float> attributes;
        std::vector<SampleClass> classes;
        std::vector<uint32_t> holders;
    };

    OutputKind kind_;
    size_t stride_;
    size_t count_ = 0;
    std::vector<Block> blocks_;
    std::vector<SampleId> free_;

    Block& block_of(SampleId id) { return blocks_[id / kBlockSize]; }
    const Block& block_of(SampleId id) const { return blocks_[id / kBlockSize]; }
    void grow() {
        const auto first = static_cast<SampleId>(blocks_.size() * kBlockSize);
        blocks_.push_back({std::vector<float>(kBlockSize * stride_), std::vector<SampleClass>(kBlockSize),
                           std::vector<uint32_t>(kBlockSize)});
        for (SampleId i = kBlockSize; i-- > 0;) free_.push_back(first + i);
    }
};

}  // namespace rayleaf
