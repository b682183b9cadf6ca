// A state for each thread that asks for one, with no limit on threads: oneTBB finds a thread's own, and a list holds
// all of them, for who wants to look at every thread's.
//
// States live as long as the list. One whose thread has ended is taken over by a later thread that gets the same number
// from the system, so there are no more of them than threads that lived at the same time.
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

    /// This thread's; made of the arguments when it first asks.
    template <typename... Arguments>
    State& local(Arguments&&... arguments) {
        Node*& own = own_.local();
        if (!own) own = listed(std::make_unique<Node>(std::forward<Arguments>(arguments)...));
        return own->state;
    }

    /// All that are listed, while other threads may make theirs. A thread whose state is missed because it was listed
    /// too late sees all that the caller wrote before, where it reads that in sequentially consistent order too.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for (const Node* node = newest_.load(); node; node = node->before) visit(node->state);
    }

    /// What a thread's state takes.
    static constexpr size_t state_bytes() { return sizeof(Node); }

  private:
    struct alignas(kCacheLine) Node {
        State state;
        Node* before = nullptr;

        template <typename... Arguments>
        explicit Node(Arguments&&... arguments) : state(std::forward<Arguments>(arguments)...) {}
    };

    mutable oneapi::tbb::enumerable_thread_specific<Node*> own_;
    /// Publishes nodes, to for_each. Sequentially consistent, as what is announced in states is: see there.
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
