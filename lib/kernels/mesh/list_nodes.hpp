// Memory of the nodes of short lists that come and go: CGAL makes some for each point that it inserts, and malloc takes
// a seventh of the mesher's time for them.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace restshape {

// Places for one object each, which are taken again in the order last left, first taken. One thread meshes at a time.
template <class Node>
class NodePool {
 public:
    static Node* take() {
        Pool& pool = shared();
        if (pool.left.empty()) pool.grow();
        Node* node = pool.left.back();
        pool.left.pop_back();
        return node;
    }
    static void leave(Node* node) noexcept { shared().left.push_back(node); }

 private:
    static constexpr std::size_t block = 256;
    struct Place {
        alignas(Node) std::byte bytes[sizeof(Node)];
    };
    struct Pool {
        std::vector<std::unique_ptr<Place[]>> blocks;
        std::vector<Node*> left;

        void grow() {
            blocks.push_back(std::make_unique<Place[]>(block));
            // So that to leave one never allocates.
            left.reserve(block * blocks.size());
            for (std::size_t k = block; k-- > 0;) left.push_back(reinterpret_cast<Node*>(blocks.back()[k].bytes));
        }
    };
    static Pool& shared() {
        static Pool pool;
        return pool;
    }
};

// An allocator of one object at a time from there, of more from the heap.
template <class Node>
struct PooledAllocator {
    using value_type = Node;
    using is_always_equal = std::true_type;
    using propagate_on_container_move_assignment = std::true_type;

    PooledAllocator() noexcept = default;
    template <class Other>
    PooledAllocator(const Other&) noexcept {}  // NOLINT: any allocator does

    Node* allocate(std::size_t count) {
        return count == 1 ? NodePool<Node>::take() : static_cast<Node*>(::operator new(count * sizeof(Node)));
    }
    void deallocate(Node* node, std::size_t count) noexcept {
        if (count == 1)
            NodePool<Node>::leave(node);
        else
            ::operator delete(node);
    }
    template <class Value, class... Arguments>
    void construct(Value* at, Arguments&&... arguments) {
        ::new (static_cast<void*>(at)) Value(std::forward<Arguments>(arguments)...);
    }
    template <class Value>
    void destroy(Value* at) noexcept {
        at->~Value();
    }
    friend bool operator==(const PooledAllocator&, const PooledAllocator&) noexcept { return true; }
    friend bool operator!=(const PooledAllocator&, const PooledAllocator&) noexcept { return false; }
};

}  // namespace restshape
