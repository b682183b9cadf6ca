// A vector in chunks that its copies share: a copy costs little, an edit copies one chunk, and what two copies have in
// common is told without looking at the items.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace rayleaf {

/// As thread-safe as a std::vector: copies may be read and edited by different threads.
template <typename T>
class ChunkedVector {
  public:
    static constexpr size_t kChunk = 256;

    ChunkedVector() = default;
    ChunkedVector(const std::vector<T>& items) {
        for (const T& item : items) push_back(item);
    }
    ChunkedVector(std::initializer_list<T> items) {
        for (const T& item : items) push_back(item);
    }

    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    void clear() {
        chunks_.clear();
        size_ = 0;
    }
    const T& operator[](size_t i) const { return (*chunks_[i / kChunk])[i % kChunk]; }
    /// To change an item; invalidates references to others.
    T& edit(size_t i) { return own(i / kChunk)[i % kChunk]; }
    void push_back(T item) {
        if (size_ % kChunk == 0) chunks_.push_back(std::make_shared<Chunk>());
        own(size_ / kChunk).push_back(std::move(item));
        ++size_;
    }
    size_t chunk_count() const { return chunks_.size(); }
    /// Whether the chunk is the other's, so that its items are equal.
    bool shares(size_t chunk, const ChunkedVector& other) const {
        return chunk < other.chunks_.size() && chunks_[chunk] == other.chunks_[chunk];
    }

    class Iterator {
      public:
        Iterator(const ChunkedVector& vector, size_t at) : vector_(&vector), at_(at) {}
        const T& operator*() const { return (*vector_)[at_]; }
        Iterator& operator++() {
            ++at_;
            return *this;
        }
        bool operator==(const Iterator& other) const { return at_ == other.at_; }

      private:
        const ChunkedVector* vector_;
        size_t at_;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, size_}; }

  private:
    using Chunk = std::vector<T>;
    std::vector<std::shared_ptr<Chunk>> chunks_;
    size_t size_ = 0;

    Chunk& own(size_t number) {
        std::shared_ptr<Chunk>& chunk = chunks_[number];
        if (chunk.use_count() > 1)
            chunk = std::make_shared<Chunk>(*chunk);
        else  // Another thread may just have let go of it: counting again makes its reads come before our writes.
            std::shared_ptr<Chunk>(chunk).reset();
        return *chunk;
    }
};

/// The numbers of the items in which two vectors of one size differ, in order.
template <typename T>
std::vector<uint32_t> differing_items(const ChunkedVector<T>& a, const ChunkedVector<T>& b) {
    std::vector<uint32_t> items;
    for (size_t chunk = 0; chunk < a.chunk_count(); ++chunk) {
        if (a.shares(chunk, b)) continue;
        const size_t first = chunk * ChunkedVector<T>::kChunk;
        for (size_t i = first; i < std::min(first + ChunkedVector<T>::kChunk, a.size()); ++i)
            if (!(a[i] == b[i])) items.push_back(static_cast<uint32_t>(i));
    }
    return items;
}

}  // namespace rayleaf
