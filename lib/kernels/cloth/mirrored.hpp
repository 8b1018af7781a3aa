// Half a hinge about an edge in a mirror: at planes of symmetry, and at clamps, whose deflection goes on as an even
// one.
#pragma once

#include <string>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

// Nodes 0 and 1 of the edge and node 2 on its left; the corner on its right is the image of node 2: in X about the
// edge, in x by the plane through node 0 across the direction t. The energy is half the whole hinge's: the other half
// is the image's.
template <class Whole>
struct MirroredElement {
    static constexpr int nodes = 3, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Stiffness [N m] as of the whole hinge; t, of length 1.
    static std::vector<std::string> parameters() { return {"k", "tx", "ty", "tz"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX wide[8];
        Sx places[12];
        R forces[12];
        with_image(X, x, p + 1, wide, places);
        Whole::residual(wide, places, p, forces);
        // Forces on the image act on nodes 0 and 2.
        const R along = (forces[9] * p[1] + forces[10] * p[2] + forces[11] * p[3]) * 2.0;
        for (int a = 0; a < 3; ++a) {
            const R turned = along * p[1 + a];
            r[a] = 0.5 * (forces[a] + turned);
            r[3 + a] = 0.5 * forces[3 + a];
            r[6 + a] = 0.5 * (forces[6 + a] + forces[9 + a] - turned);
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        SX wide[8];
        Sx places[12];
        with_image(X, x, p + 1, wide, places);
        return 0.5 * Whole::energy(wide, places, p);
    }

 private:
    template <class SX, class Sx>
    static void with_image(const SX* X, const Sx* x, const double* t, SX (&wide)[8], Sx (&places)[12]) {
        for (int k = 0; k < 6; ++k) wide[k] = X[k];
        for (int k = 0; k < 9; ++k) places[k] = x[k];
        const SX e[2] = {X[2] - X[0], X[3] - X[1]}, corner[2] = {X[4] - X[0], X[5] - X[1]};
        const SX share = (e[0] * corner[0] + e[1] * corner[1]) * 2.0 / (e[0] * e[0] + e[1] * e[1]);
        for (int a = 0; a < 2; ++a) wide[6 + a] = X[a] + e[a] * share - corner[a];
        const Sx twice = ((x[6] - x[0]) * t[0] + (x[7] - x[1]) * t[1] + (x[8] - x[2]) * t[2]) * 2.0;
        for (int a = 0; a < 3; ++a) places[9 + a] = x[6 + a] - twice * t[a];
    }
};

}  // namespace restshape
