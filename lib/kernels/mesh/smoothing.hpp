// Relocation by springs of zero rest length: every free node goes to the mean of its neighbours.
#pragma once

#include <cstdint>
#include <vector>

namespace restshape {

// Nodes on the boundary follow it: X = X_reference + c0 Psi[0] + c1 Psi[1] where fixed.
inline void move_fixed_nodes(const double* X_reference, const double* Psi, double c0, double c1,
                             const std::uint8_t* fixed, double* X, std::ptrdiff_t nodes) {
    for (std::ptrdiff_t i = 0; i < nodes; ++i) {
        if (!fixed[i]) continue;
        for (std::ptrdiff_t k = 2 * i; k < 2 * i + 2; ++k) {
            X[k] = X_reference[k] + c0 * Psi[k] + c1 * Psi[2 * nodes + k];
        }
    }
}

// Jacobi sweeps over the mesh edges.
inline void laplacian_sweeps(double* X, std::ptrdiff_t nodes, const std::int32_t* edges, std::ptrdiff_t edge_count,
                             const std::uint8_t* fixed, int sweeps) {
    std::vector<double> work;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        work.assign(3 * nodes, 0.0);
        for (std::ptrdiff_t e = 0; e < edge_count; ++e) {
            const std::int32_t a = edges[2 * e], b = edges[2 * e + 1];
            work[3 * a] += X[2 * b], work[3 * a + 1] += X[2 * b + 1], work[3 * a + 2] += 1.0;
            work[3 * b] += X[2 * a], work[3 * b + 1] += X[2 * a + 1], work[3 * b + 2] += 1.0;
        }
        for (std::ptrdiff_t i = 0; i < nodes; ++i) {
            if (!fixed[i] && work[3 * i + 2] > 0.0) {
                X[2 * i] = work[3 * i] / work[3 * i + 2];
                X[2 * i + 1] = work[3 * i + 1] / work[3 * i + 2];
            }
        }
    }
}

}  // namespace restshape
