// Places of the corners of several triangles at once, one SIMD lane a triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "fem/pack.hpp"

namespace restshape {

// First and second coordinates of the nodes that a corner has in several cells, from (n, 2).
[[gnu::always_inline]] inline void corner_of(const double* places, const int32_t* const (&cells)[pack_lanes],
                                             int corner, Pack& first, Pack& second) {
    using Pair = double __attribute__((vector_size(2 * sizeof(double))));
    Pair pairs[pack_lanes];
#pragma GCC unroll 8
    for (int lane = 0; lane < pack_lanes; ++lane)
        std::memcpy(&pairs[lane], places + 2 * static_cast<size_t>(cells[lane][corner]), sizeof(Pair));
    const auto join = [&](int k) { return __builtin_shufflevector(pairs[k], pairs[k + 1], 0, 2, 1, 3); };
    const auto low = __builtin_shufflevector(join(0), join(2), 0, 1, 4, 5, 2, 3, 6, 7);
    const auto high = __builtin_shufflevector(join(4), join(6), 0, 1, 4, 5, 2, 3, 6, 7);
    first = __builtin_shufflevector(low, high, 0, 1, 2, 3, 8, 9, 10, 11);
    second = __builtin_shufflevector(low, high, 4, 5, 6, 7, 12, 13, 14, 15);
}

}  // namespace restshape
