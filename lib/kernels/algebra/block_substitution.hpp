// Substitutions with a factor of BlockFactor in its own place, where panels of it would double the memory.
#pragma once

#include <petscsys.h>

#include <cstddef>

#include "algebra/block_factor.hpp"

namespace restshape {

// Adds to `sum` the product of a block, by columns, with some numbers.
template <int size>
void add_product(const double* block, const double* with, double (&sum)[size]) {
    for (int c = 0; c < size; ++c)
        for (int r = 0; r < size; ++r) sum[r] += block[c * size + r] * with[c];
}

// x = (U^T D)^-1 b, which x is before.
template <int size>
void substitute_forward(const BlockRows& u, double* x) {
    constexpr std::size_t numbers = size * size;
    for (PetscInt k = 0; k < u.count; ++k) {
        double *at = x + static_cast<std::size_t>(k) * size, own[size], scaled[size] = {};
        for (int r = 0; r < size; ++r) own[r] = at[r];
        for (PetscInt j = u.start[k]; j < u.start[k + 1]; ++j) {
            const double* block = u.value + j * numbers;
            double* to = x + static_cast<std::size_t>(u.column[j]) * size;
            for (int c = 0; c < size; ++c) {
                double sum = to[c];
                for (int r = 0; r < size; ++r) sum += block[c * size + r] * own[r];
                to[c] = sum;
            }
        }
        add_product<size>(u.value + k * numbers, own, scaled);
        for (int r = 0; r < size; ++r) at[r] = scaled[r];
    }
}

// x = U^-1 b, which x is before.
template <int size>
void substitute_backward(const BlockRows& u, double* x) {
    constexpr std::size_t numbers = size * size;
    for (PetscInt k = u.count - 1; k >= 0; --k) {
        // Two sums, of which neither waits for the other.
        double *at = x + static_cast<std::size_t>(k) * size, even[size] = {}, odd[size] = {};
        const auto add = [&](PetscInt j, double(&sum)[size]) {
            add_product<size>(u.value + j * numbers, x + static_cast<std::size_t>(u.column[j]) * size, sum);
        };
        PetscInt j = u.start[k];
        for (; j + 1 < u.start[k + 1]; j += 2) add(j, even), add(j + 1, odd);
        if (j < u.start[k + 1]) add(j, even);
        for (int r = 0; r < size; ++r) at[r] += even[r] + odd[r];
    }
}

// Solves U^T D U x = b for all unknowns x, which are b before.
template <int size>
void substitute(const BlockRows& u, double* x) {
    substitute_forward<size>(u, x);
    substitute_backward<size>(u, x);
}

}  // namespace restshape
