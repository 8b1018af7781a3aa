// Several elements at once, one SIMD lane an element: numbers, and their derivatives in N directions.
#pragma once

#include <cmath>
#include <cstring>

namespace restshape {

// As many as one register takes: GCC has longer vectors in memory, and copies them in parts.
#if defined(__AVX512F__)
constexpr int pack_lanes = 8;
#elif defined(__AVX__)
constexpr int pack_lanes = 4;
#else
constexpr int pack_lanes = 2;
#endif

using Pack = double __attribute__((vector_size(pack_lanes * sizeof(double))));
using TwoLanes = double __attribute__((vector_size(2 * sizeof(double))));
using FourLanes = double __attribute__((vector_size(4 * sizeof(double))));
using EightLanes = double __attribute__((vector_size(8 * sizeof(double))));

[[gnu::always_inline]] inline Pack square_root(Pack a) {
    for (int lane = 0; lane < pack_lanes; ++lane) a[lane] = std::sqrt(a[lane]);
    return a;
}

[[gnu::always_inline]] inline Pack larger(const Pack& a, const Pack& b) { return a > b ? a : b; }

// Whether comparisons of packs hold in every lane.
template <class Lanes>
[[gnu::always_inline]] inline bool all(const Lanes& holds) {
    auto found = holds[0];
    for (int lane = 1; lane < pack_lanes; ++lane) found &= holds[lane];
    return found;
}

// The value alone, as of dual numbers.
inline const Pack& value_of(const Pack& a) { return a; }

// Lane i of rows[j] and lane j of rows[i] change places.
[[gnu::always_inline]] inline void transpose(EightLanes (&rows)[8]) {
    EightLanes pairs[8], fours[8];
#pragma GCC unroll 4
    for (int i = 0; i < 8; i += 2) {
        pairs[i] = __builtin_shufflevector(rows[i], rows[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        pairs[i + 1] = __builtin_shufflevector(rows[i], rows[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        const int i = k / 2 * 4 + k % 2;
        fours[i] = __builtin_shufflevector(pairs[i], pairs[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        fours[i + 2] = __builtin_shufflevector(pairs[i], pairs[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        rows[i] = __builtin_shufflevector(fours[i], fours[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        rows[i + 4] = __builtin_shufflevector(fours[i], fours[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}
[[gnu::always_inline]] inline void transpose(FourLanes (&rows)[4]) {
    FourLanes pairs[4];
#pragma GCC unroll 2
    for (int i = 0; i < 4; i += 2) {
        pairs[i] = __builtin_shufflevector(rows[i], rows[i + 1], 0, 4, 2, 6);
        pairs[i + 1] = __builtin_shufflevector(rows[i], rows[i + 1], 1, 5, 3, 7);
    }
#pragma GCC unroll 2
    for (int i = 0; i < 2; ++i) {
        rows[i] = __builtin_shufflevector(pairs[i], pairs[i + 2], 0, 1, 4, 5);
        rows[i + 2] = __builtin_shufflevector(pairs[i], pairs[i + 2], 2, 3, 6, 7);
    }
}
[[gnu::always_inline]] inline void transpose(TwoLanes (&rows)[2]) {
    const TwoLanes first = rows[0];
    rows[0] = __builtin_shufflevector(first, rows[1], 0, 2);
    rows[1] = __builtin_shufflevector(first, rows[1], 1, 3);
}

// Lane i of n packs to the numbers from to + i * stride, which is a multiple of the lanes, as there is room for.
[[gnu::always_inline]] inline void spread(const Pack* rows, int n, double* to, int stride) {
    for (int first = 0; first < n; first += pack_lanes) {
        const Pack* from = rows + first;
        const int count = n - first;
        if (count <= 2) {  // cheaper than half-empty packs
            for (int k = 0; k < count; ++k)
                for (int lane = 0; lane < pack_lanes; ++lane) to[lane * stride + first + k] = from[k][lane];
            return;
        }
        Pack part[pack_lanes];
#pragma GCC unroll 8
        for (int k = 0; k < pack_lanes; ++k) part[k] = from[k < count ? k : count - 1];
        transpose(part);
#pragma GCC unroll 8
        for (int lane = 0; lane < pack_lanes; ++lane)
            std::memcpy(to + lane * stride + first, part + lane, sizeof(Pack));
    }
}

// A value and its derivatives in N directions, of several elements.
template <int N>
struct PackDual {
    Pack v, d[N];

    // The k-th independent variable.
    static PackDual seed(const Pack& value, int k) {
        PackDual s{value, {}};
        s.d[k] += 1.0;
        return s;
    }

    PackDual& operator+=(const PackDual& o) {
        v += o.v;
        for (int k = 0; k < N; ++k) d[k] += o.d[k];
        return *this;
    }
    friend PackDual operator+(PackDual a, const PackDual& b) { return a += b; }
    friend PackDual operator*(const PackDual& a, const PackDual& b) {
        PackDual product{a.v * b.v, {}};
        for (int k = 0; k < N; ++k) product.d[k] = a.d[k] * b.v + b.d[k] * a.v;
        return product;
    }
    friend PackDual operator*(PackDual a, const Pack& c) {
        a.v *= c;
        for (int k = 0; k < N; ++k) a.d[k] *= c;
        return a;
    }
    friend PackDual operator*(double c, PackDual a) {
        a.v *= c;
        for (int k = 0; k < N; ++k) a.d[k] *= c;
        return a;
    }
};

}  // namespace restshape
