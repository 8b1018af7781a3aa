// A binary tree of boxes over parts of a sheet, which go straight ways.
//
// It is made once over the flat sheet and fitted to each way: what is near in the sheet stays near in space. A box has
// two places, where its parts begin and where they end: two boxes are apart all the way where one is on the same side
// of the other along an axis at both, however far they go together.
// Source: Ericson, Real-Time Collision Detection, 2005, 6.6 (refitting).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "cloth/part_distance.hpp"

namespace restshape {

constexpr int box_lanes = 8;
using BoxFloats [[gnu::vector_size(box_lanes * sizeof(float))]] = float;
using BoxMask [[gnu::vector_size(box_lanes * sizeof(int32_t))]] = int32_t;
using FourLongs [[gnu::vector_size(box_lanes * sizeof(int32_t))]] = int64_t;

inline BoxFloats least(const BoxFloats& a, const BoxFloats& b) { return a < b ? a : b; }
inline BoxFloats most(const BoxFloats& a, const BoxFloats& b) { return a > b ? a : b; }

// x, y, z and 0 where something begins, and where it ends; rounded outwards.
struct Box {
    BoxFloats low = BoxFloats{INFINITY, INFINITY, INFINITY, 0.0F, INFINITY, INFINITY, INFINITY, 0.0F};
    BoxFloats high = -low;

    static Box around(const Point3& from, const Point3& to, double margin) {
        const double at[box_lanes] = {from.x, from.y, from.z, 0.0, to.x, to.y, to.z, 0.0};
        Box box;
        for (int a = 0; a < box_lanes; ++a) {
            // More than what the nearest single number may be off.
            const double wide = a % 4 == 3 ? 0.0 : margin + (std::abs(at[a]) + margin) * 1.2e-7;
            box.low[a] = static_cast<float>(at[a] - wide);
            box.high[a] = static_cast<float>(at[a] + wide);
        }
        return box;
    }
    void hold(const Box& o) {
        low = least(low, o.low);
        high = most(high, o.high);
    }
    // False where both are apart all the way.
    bool meets(const Box& o) const {
        const BoxFloats below = o.low - high, above = low - o.high;
        const BoxFloats gap = most(both_ends(below), both_ends(above));
        const auto apart = reinterpret_cast<FourLongs>(gap > 0.0F);
        return !(apart[0] | apart[1]);
    }

 private:
    // The lesser of what is there at the beginning and at the end, in the first lanes.
    static BoxFloats both_ends(const BoxFloats& a) {
        return least(a, __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3));
    }
};

// Children have larger numbers than their parents.
class BoxTree {
 public:
    BoxTree(const int32_t* nodes, int count, int width, const double* X)
        : count_(count), width_(width), nodes_(nodes, nodes + static_cast<size_t>(count) * width) {
        std::vector<std::array<double, 2>> middle(count, {0.0, 0.0});
        for (int i = 0; i < count * width; ++i)
            for (int a = 0; a < 2; ++a) middle[i / width][a] += X[2 * nodes[i] + a];
        std::vector<int> order(count);
        std::iota(order.begin(), order.end(), 0);
        if (count) split(order, 0, count, middle);
    }

    int count() const { return count_; }
    const int32_t* item(int i) const { return nodes_.data() + static_cast<size_t>(i) * width_; }

    double most_of(const double* values, int i) const {
        double most = values[item(i)[0]];
        for (int k = 1; k < width_; ++k) most = std::max(most, values[item(i)[k]]);
        return most;
    }

    // Boxes around those of the nodes.
    void fit(const Box* nodes) {
        for (size_t k = branches_.size(); k-- > 0;) {
            Branch& b = branches_[k];
            b.box = b.left ? branches_[b.left].box : leaves_[b.leaf].fit(*this, nodes);
            if (b.left) b.box.hold(branches_[b.right].box);
        }
    }

    // Calls found(i, j) for pairs of different items of this tree, each once.
    template <class Found>
    void with_itself(const Found& found) const {
        if (!branches_.empty()) itself(0, found);
    }
    // Calls found(i, j) for items i of this tree and j of another one.
    template <class Found>
    void with(const BoxTree& other, const Found& found) const {
        if (!branches_.empty() && !other.branches_.empty()) both(0, other, 0, found);
    }

 private:
    // The boxes of a few items, one in each lane.
    struct Leaf {
        int count = 0;
        std::array<int, box_lanes> items{};
        std::array<BoxFloats, 6> low, high;  // by place and axis

        // Lanes without an item meet nothing.
        Leaf() {
            low.fill(BoxFloats{} + INFINITY);
            high.fill(BoxFloats{} - INFINITY);
        }

        Box fit(const BoxTree& tree, const Box* nodes) {
            Box all;
            for (int i = 0; i < count; ++i) {
                const int32_t* node = tree.item(items[i]);
                Box own = nodes[node[0]];
                for (int k = 1; k < tree.width_; ++k) own.hold(nodes[node[k]]);
                all.hold(own);
                for (int a = 0; a < 6; ++a) {
                    low[a][i] = own.low[lane(a)];
                    high[a][i] = own.high[lane(a)];
                }
            }
            return all;
        }
        // The lanes whose boxes meet one with these bounds by place and axis, one bit each.
        template <class Low, class High>
        unsigned met_by(const Low& its_low, const High& its_high) const {
            BoxFloats gap = BoxFloats{} - 1.0F;
            for (int a = 0; a < 3; ++a) {
                gap = most(gap, least(its_low(a) - high[a], its_low(a + 3) - high[a + 3]));
                gap = most(gap, least(low[a] - its_high(a), low[a + 3] - its_high(a + 3)));
            }
            const auto bits = reinterpret_cast<FourLongs>(~(gap > 0.0F) & BoxMask{1, 2, 4, 8, 16, 32, 64, 128});
            const int64_t all = bits[0] | bits[1] | bits[2] | bits[3];
            return static_cast<unsigned>(all | (all >> 32)) & 0xffU;
        }
        unsigned met_by(const Leaf& other, int i) const {
            return met_by([&](int a) { return other.low[a][i]; }, [&](int a) { return other.high[a][i]; });
        }
        unsigned met_by(const Box& other) const {
            return met_by([&](int a) { return other.low[lane(a)]; }, [&](int a) { return other.high[lane(a)]; });
        }
        static int lane(int a) { return a < 3 ? a : a + 1; }
    };
    struct Branch {
        int first, end, left = 0, right = 0, leaf = 0;
        Box box{};
        Branch(int from, int to) : first(from), end(to) {}
    };

    int split(std::vector<int>& order, int first, int end, const std::vector<std::array<double, 2>>& middle) {
        const int number = static_cast<int>(branches_.size()), size = end - first;
        branches_.emplace_back(first, end);
        if (size <= box_lanes) {
            branches_[number].leaf = static_cast<int>(leaves_.size());
            Leaf& leaf = leaves_.emplace_back();
            leaf.count = size;
            std::copy(order.begin() + first, order.begin() + end, leaf.items.begin());
            return number;
        }
        std::array<double, 2> low = middle[order[first]], high = low;
        for (int i = first; i < end; ++i)
            for (int a = 0; a < 2; ++a) {
                low[a] = std::min(low[a], middle[order[i]][a]);
                high[a] = std::max(high[a], middle[order[i]][a]);
            }
        // Leaves on the left are full.
        const int axis = high[1] - low[1] > high[0] - low[0], half = first + (size / 2 + 7) / box_lanes * box_lanes;
        std::nth_element(order.begin() + first, order.begin() + half, order.begin() + end, [&](int i, int j) {
            return std::make_pair(middle[i][axis], i) < std::make_pair(middle[j][axis], j);
        });
        const int left = split(order, first, half, middle), right = split(order, half, end, middle);
        branches_[number].left = left;
        branches_[number].right = right;
        return number;
    }

    template <class Found>
    void itself(int k, const Found& found) const {
        const Branch& b = branches_[k];
        if (b.left) {
            itself(b.left, found);
            itself(b.right, found);
            both(b.left, *this, b.right, found);
            return;
        }
        const Leaf& leaf = leaves_[b.leaf];
        for (int i = 0; i < leaf.count; ++i) report(leaf, i, leaf, leaf.met_by(leaf, i) >> (i + 1) << (i + 1), found);
    }

    template <class Found>
    void both(int k, const BoxTree& other, int l, const Found& found) const {
        const Branch &b = branches_[k], &c = other.branches_[l];
        if (!b.box.meets(c.box)) return;
        if (!b.left && !c.left) {
            const Leaf &mine = leaves_[b.leaf], &its = other.leaves_[c.leaf];
            for (unsigned met = mine.met_by(c.box); met; met &= met - 1) {
                const int i = __builtin_ctz(met);
                report(mine, i, its, its.met_by(mine, i), found);
            }
        } else if (b.left && (!c.left || b.end - b.first >= c.end - c.first)) {
            both(b.left, other, l, found);
            both(b.right, other, l, found);
        } else {
            both(k, other, c.left, found);
            both(k, other, c.right, found);
        }
    }

    template <class Found>
    static void report(const Leaf& mine, int i, const Leaf& its, unsigned met, const Found& found) {
        for (; met; met &= met - 1) found(mine.items[i], its.items[__builtin_ctz(met)]);
    }

    int count_, width_;
    std::vector<int32_t> nodes_;
    std::vector<Branch> branches_;
    std::vector<Leaf> leaves_;
};

}  // namespace restshape
