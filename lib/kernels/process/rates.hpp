// What one core moves and computes in a second: rates that times are held against.
//
// Source: J. D. McCalpin, Memory bandwidth and machine balance in current high performance computers, IEEE TCCA
// Newsletter (1995) 19: the triad of STREAM.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <limits>

namespace restshape {

using RateClock = std::chrono::steady_clock;

// Seconds of a pass a = b + s c over n numbers each: the least of some runs of `passes` each.
inline double triad_seconds(double* a, const double* b, const double* c, size_t n, int passes, int runs) {
    double best = std::numeric_limits<double>::infinity();
    double* __restrict to = a;
    for (int run = 0; run <= runs; ++run) {
        const auto start = RateClock::now();
        for (int pass = 0; pass < passes; ++pass) {
            const double s = 1.0 + pass;
            for (size_t i = 0; i < n; ++i) to[i] = b[i] + s * c[i];
            // Each pass counts, though the next one writes over it.
            asm volatile("" : : "r"(to) : "memory");
        }
        const std::chrono::duration<double> taken = RateClock::now() - start;
        // The first run brings the arrays into the caches.
        if (run) best = std::min(best, taken.count() / passes);
    }
    return best;
}

// Multiplications and additions a second of independent chains in registers, in the widest instructions that this
// was compiled for: the best of some runs.
inline double flop_rate(int steps, int runs) {
#ifdef __AVX512F__
    using Vector [[gnu::vector_size(64)]] = double;
#else
    using Vector [[gnu::vector_size(32)]] = double;
#endif
    constexpr int chains = 12, width = sizeof(Vector) / sizeof(double);
    Vector sum[chains];
    for (int k = 0; k < chains; ++k) sum[k] = Vector{} + 1.0 * k;
    double best = 0.0;
    for (int run = 0; run <= runs; ++run) {
        Vector factor = Vector{} + 0.999, term = Vector{} + 0.001;
        const auto start = RateClock::now();
        for (int step = 0; step < steps; ++step)
            for (int k = 0; k < chains; ++k) sum[k] = sum[k] * factor + term;
        for (int k = 0; k < chains; ++k) asm volatile("" : : "m"(sum[k]));
        const std::chrono::duration<double> taken = RateClock::now() - start;
        if (run) best = std::max(best, 2.0 * chains * width * steps / taken.count());
    }
    return best;
}

}  // namespace restshape
