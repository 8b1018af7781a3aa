// Places of the corners of several triangles at once, one SIMD lane a triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "fem/pack.hpp"

namespace restshape {

// First and second coordinates of the nodes that a corner has in several cells, from (n, 2).
[[gnu::always_inline]] inline void corner_of(const double* places, const int32_t* const (&cells)[8], int corner,
                                             EightLanes& first, EightLanes& second) {
    TwoLanes pairs[8];
#pragma GCC unroll 8
    for (int lane = 0; lane < 8; ++lane)
        std::memcpy(&pairs[lane], places + 2 * static_cast<size_t>(cells[lane][corner]), sizeof(pairs[lane]));
    const auto join = [&](int k) { return __builtin_shufflevector(pairs[k], pairs[k + 1], 0, 2, 1, 3); };
    const auto low = __builtin_shufflevector(join(0), join(2), 0, 1, 4, 5, 2, 3, 6, 7);
    const auto high = __builtin_shufflevector(join(4), join(6), 0, 1, 4, 5, 2, 3, 6, 7);
    first = __builtin_shufflevector(low, high, 0, 1, 2, 3, 8, 9, 10, 11);
    second = __builtin_shufflevector(low, high, 4, 5, 6, 7, 12, 13, 14, 15);
}
[[gnu::always_inline]] inline void corner_of(const double* places, const int32_t* const (&cells)[4], int corner,
                                             FourLanes& first, FourLanes& second) {
    TwoLanes pairs[4];
#pragma GCC unroll 4
    for (int lane = 0; lane < 4; ++lane)
        std::memcpy(&pairs[lane], places + 2 * static_cast<size_t>(cells[lane][corner]), sizeof(pairs[lane]));
    const auto even = __builtin_shufflevector(pairs[0], pairs[2], 0, 1, 2, 3);
    const auto odd = __builtin_shufflevector(pairs[1], pairs[3], 0, 1, 2, 3);
    first = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
    second = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
}
[[gnu::always_inline]] inline void corner_of(const double* places, const int32_t* const (&cells)[2], int corner,
                                             TwoLanes& first, TwoLanes& second) {
    TwoLanes pairs[2];
#pragma GCC unroll 2
    for (int lane = 0; lane < 2; ++lane)
        std::memcpy(&pairs[lane], places + 2 * static_cast<size_t>(cells[lane][corner]), sizeof(pairs[lane]));
    first = __builtin_shufflevector(pairs[0], pairs[1], 0, 2);
    second = __builtin_shufflevector(pairs[0], pairs[1], 1, 3);
}

}  // namespace restshape
