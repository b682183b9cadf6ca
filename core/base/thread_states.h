// A state for each thread that asks for one, for any number of threads: oneTBB finds a thread's own, and a list holds
// all of them, to visit those of all threads.
//
// States live as long as the list. The state of a thread that has ended is reused by a later thread with the same
// system id, so there are at most as many as threads that lived at the same time.
#pragma once

#include "base/cache_line.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>

namespace rayleaf {

template <typename State>
class ThreadStates {
  public:
    ThreadStates() = default;
    ~ThreadStates() {
        for (Node* node = newest_.load(); node;) delete std::exchange(node, node->before);
    }
    ThreadStates(const ThreadStates&) = delete;
    ThreadStates& operator=(const ThreadStates&) = delete;

    /// The calling thread's state; constructed from the arguments when it first asks.
    template <typename... Arguments>
    State& local(Arguments&&... arguments) {
        Node*& own = own_.local();
        if (!own) own = listed(std::make_unique<Node>(std::forward<Arguments>(arguments)...));
        return own->state;
    }

    /// Visits all listed states, while other threads may add theirs. A thread whose state is listed too late to be
    /// visited sees everything that the caller wrote before, if it reads that with sequential consistency.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for (const Node* node = newest_.load(); node; node = node->before) visit(node->state);
    }

    /// Memory of one thread's state.
    static constexpr size_t state_bytes() { return sizeof(Node); }

  private:
    struct alignas(kCacheLine) Node {
        State state;
        Node* before = nullptr;

        template <typename... Arguments>
        explicit Node(Arguments&&... arguments) : state(std::forward<Arguments>(arguments)...) {}
    };

    /// Memory from the C++ library, not from oneTBB's own allocator: one thread may get what another gave back, and the
    /// thread sanitizer sees the order of that only where it knows the allocator.
    mutable oneapi::tbb::enumerable_thread_specific<Node*, std::allocator<Node*>> own_;
    /// Publishes nodes to for_each. Sequentially consistent, like announcements in states: see there.
    std::atomic<Node*> newest_{nullptr};

    Node* listed(std::unique_ptr<Node> made) {
        Node* node = made.release();
        node->before = newest_.load();
        while (!newest_.compare_exchange_weak(node->before, node)) {
        }
        return node;
    }
};

}  // namespace rayleaf
