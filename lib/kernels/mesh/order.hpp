// Orders of nodes, triangles and edges that keep neighbours close in memory, and the edges of triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace restshape {

// Place of a square of a grid of 2^bits x 2^bits along the Hilbert curve that fills it.
inline std::int64_t hilbert_key(std::uint32_t x, std::uint32_t y, int bits) {
    std::int64_t key = 0;
    for (int bit = bits - 1; bit >= 0; --bit) {
        const std::uint32_t rx = (x >> bit) & 1, ry = (y >> bit) & 1;
        key += static_cast<std::int64_t>((3 * rx) ^ ry) << (2 * bit);
        if (ry) continue;
        // The quadrant's own curve is a turned one: reflect and swap so that the next bit reads like the first.
        if (rx) x ^= (1u << bit) - 1, y ^= (1u << bit) - 1;
        std::swap(x, y);
    }
    return key;
}

// Keys of points (n, 2) in the box around all of them; a grid of 16 squares a point distinguishes all but the closest.
inline std::vector<std::int64_t> hilbert_keys(const double* X, std::int32_t nodes) {
    std::vector<std::int64_t> keys(nodes);
    double low[2], extent = 0.0;
    for (int k = 0; k < 2; ++k) {
        double high = -std::numeric_limits<double>::infinity();
        low[k] = -high;
        for (std::int32_t i = 0; i < nodes; ++i) {
            low[k] = std::min(low[k], X[2 * i + k]);
            high = std::max(high, X[2 * i + k]);
        }
        extent = std::max(extent, high - low[k]);
    }
    const int bits = static_cast<int>(std::ceil(0.5 * std::log2(std::max(1, nodes)))) + 2;
    const double scale = extent > 0.0 ? (std::ldexp(1.0, bits) - 1.0) / extent : 0.0;
    for (std::int32_t i = 0; i < nodes; ++i)
        keys[i] = hilbert_key(static_cast<std::uint32_t>((X[2 * i] - low[0]) * scale),
                              static_cast<std::uint32_t>((X[2 * i + 1] - low[1]) * scale), bits);
    return keys;
}

// First place of each bucket when `count` things are put in order of their bucket.
template <class Bucket>
std::vector<std::int32_t> bucket_starts(std::int32_t buckets, std::int32_t count, Bucket bucket) {
    std::vector<std::int32_t> first(buckets + 1, 0);
    for (std::int32_t i = 0; i < count; ++i) ++first[bucket(i) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    return first;
}

// Sorts few things, by insertion.
template <class Before>
void sort_few(std::int32_t* begin, std::int32_t* end, Before before) {
    if (end - begin > 32) return std::sort(begin, end, before);
    for (std::int32_t* at = begin; at < end; ++at) {
        const std::int32_t value = *at;
        std::int32_t* to = at;
        for (; to > begin && before(value, to[-1]); --to) *to = to[-1];
        *to = value;
    }
}

// Nodes in their order along a Hilbert curve.
inline void node_order(const double* X, std::int32_t nodes, std::int32_t* order) {
    const auto keys = hilbert_keys(X, nodes);
    const bool small = std::all_of(keys.begin(), keys.end(), [](std::int64_t key) { return key >> 31 == 0; });
    if (small) {
        // Key and number in one word: half the time.
        std::vector<std::uint64_t> words(nodes);
        for (std::int32_t i = 0; i < nodes; ++i)
            words[i] = static_cast<std::uint64_t>(keys[i]) << 32 | static_cast<std::uint32_t>(i);
        std::sort(words.begin(), words.end());
        for (std::int32_t i = 0; i < nodes; ++i) order[i] = static_cast<std::int32_t>(words[i]);
        return;
    }
    std::vector<std::pair<std::int64_t, std::int32_t>> sorted(nodes);
    for (std::int32_t i = 0; i < nodes; ++i) sorted[i] = {keys[i], i};
    std::sort(sorted.begin(), sorted.end());
    for (std::int32_t i = 0; i < nodes; ++i) order[i] = sorted[i].second;
}

// Triangles in their new order: by the smallest node, then by the others.
inline void cell_order(const std::int32_t* cells, std::int32_t count, std::int32_t nodes, std::int32_t* order) {
    std::vector<std::array<std::int32_t, 3>> sorted(count);
    for (std::int32_t i = 0; i < count; ++i) {
        const std::int32_t a = cells[3 * i], b = cells[3 * i + 1], c = cells[3 * i + 2];
        const std::int32_t low = std::min({a, b, c}), high = std::max({a, b, c});
        sorted[i] = {low, a ^ b ^ c ^ low ^ high, high};
    }
    auto next = bucket_starts(nodes, count, [&](std::int32_t i) { return sorted[i][0]; });
    const auto first = next;
    for (std::int32_t i = 0; i < count; ++i) order[next[sorted[i][0]]++] = i;
    for (std::int32_t node = 0; node < nodes; ++node)
        sort_few(order + first[node], order + first[node + 1], [&](std::int32_t a, std::int32_t b) {
            return sorted[a] != sorted[b] ? sorted[a] < sorted[b] : a < b;
        });
}

// Edges of triangles, sorted by their smaller, then their larger node; cell_edges names those opposite to each corner.
inline std::vector<std::int32_t> edges_of_cells(const std::int32_t* cells, std::int32_t count, std::int32_t nodes,
                                                std::int32_t* cell_edges) {
    // By the larger, then by the smaller node, each time in the order of before.
    const std::int32_t side_count = 3 * count;
    std::vector<std::int32_t> low(side_count), high(side_count), by_high(side_count), by_low(side_count);
    for (std::int32_t i = 0; i < side_count; i += 3)
        for (int j = 0; j < 3; ++j)
            std::tie(low[i + j], high[i + j]) = std::minmax(cells[i + (j + 1) % 3], cells[i + (j + 2) % 3]);
    auto next = bucket_starts(nodes, side_count, [&](std::int32_t side) { return high[side]; });
    for (std::int32_t side = 0; side < side_count; ++side) by_high[next[high[side]]++] = side;
    next = bucket_starts(nodes, side_count, [&](std::int32_t side) { return low[side]; });
    for (const std::int32_t side : by_high) by_low[next[low[side]]++] = side;
    std::vector<std::int32_t> edges;
    edges.reserve(side_count + 3);
    std::int32_t a = -1, b = -1;
    for (const std::int32_t side : by_low) {
        if (low[side] != a || high[side] != b) {
            a = low[side], b = high[side];
            edges.push_back(a), edges.push_back(b);
        }
        cell_edges[side] = static_cast<std::int32_t>(edges.size() / 2 - 1);
    }
    return edges;
}

// The triangle to the left of each directed pair of nodes, -1 where there is none.
inline void cells_left_of(const std::int32_t* facets, std::int32_t facet_count, const std::int32_t* cells,
                          std::int32_t count, std::int32_t nodes, std::int32_t* left) {
    auto next = bucket_starts(nodes, facet_count, [&](std::int32_t i) { return facets[2 * i]; });
    const auto first = next;
    std::vector<std::int32_t> of_node(facet_count);
    for (std::int32_t i = 0; i < facet_count; ++i) of_node[next[facets[2 * i]]++] = i;
    std::fill(left, left + facet_count, -1);
    for (std::int32_t i = 0; i < 3 * count; ++i) {
        const std::int32_t a = cells[i], b = cells[i % 3 == 2 ? i - 2 : i + 1];
        for (std::int32_t k = first[a]; k < first[a + 1]; ++k)
            if (facets[2 * of_node[k] + 1] == b) left[of_node[k]] = i / 3;
    }
}

}  // namespace restshape
