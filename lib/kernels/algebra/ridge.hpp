// A small system with a ridge, solved by elimination.
#pragma once

#include <cstddef>

namespace restshape {

// Solves (gram + shift) w = products for weights (k,), where the shift is `ridge` of the trace; 0 where that is 0.
void solve_with_ridge(const double* gram, const double* products, std::ptrdiff_t k, double ridge, double* weights);

}  // namespace restshape
