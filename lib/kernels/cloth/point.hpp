// Quadratic potentials at a node or at a point of a triangle: what contact, friction or a spring does there.
#pragma once

#include <string>
#include <vector>

#include "fem/dual.hpp"

namespace restshape {

// g . (x - x0) + (x - x0) . H (x - x0)/2. Where x is x0, residual and tangent are g and H.
struct PointPotentialElement {
    static constexpr int nodes = 1, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Place x0 [m], gradient there [N], second derivatives [N/m].
    static std::vector<std::string> parameters() {
        return {"x0", "y0", "z0", "gx", "gy", "gz", "Hxx", "Hyy", "Hzz", "Hyz", "Hxz", "Hxy"};
    }

    template <class SX, class Sx, class R>
    static void residual(const SX*, const Sx* x, const double* p, R* r) {
        const Sx u[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
        r[0] = R(u[0] * p[6] + u[1] * p[11] + u[2] * p[10] + p[3]);
        r[1] = R(u[0] * p[11] + u[1] * p[7] + u[2] * p[9] + p[4]);
        r[2] = R(u[0] * p[10] + u[1] * p[9] + u[2] * p[8] + p[5]);
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        Sx r[3], total(0.0);
        residual(X, x, p, r);
        for (int a = 0; a < 3; ++a) total += (x[a] - p[a]) * (0.5 * (r[a] + p[3 + a]));
        return Common<SX, Sx>(1.0) * total;
    }
};

// The same at the point b0 x0 + b1 x1 + b2 x2 of a triangle, with barycentric coordinates b that add up to 1.
struct TrianglePotentialElement {
    static constexpr int nodes = 3, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Barycentric coordinates, then what a node has.
    static std::vector<std::string> parameters() {
        std::vector<std::string> names = {"b0", "b1", "b2"};
        for (const std::string& name : PointPotentialElement::parameters()) names.push_back(name);
        return names;
    }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        Sx y[3];
        R force[3];
        point(x, p, y);
        PointPotentialElement::residual(X, y, p + 3, force);
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a) r[3 * i + a] = p[i] * force[a];
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        Sx y[3];
        point(x, p, y);
        return PointPotentialElement::energy(X, y, p + 3);
    }

    // By hand: the block of nodes i and j is b_i b_j H.
    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        constexpr int stride = Dual<9>::lanes, of[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
        residual(X, x, p, r);
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a)
                for (int j = 0; j < 3; ++j)
                    for (int b = 0; b < 3; ++b) K[(3 * i + a) * stride + 3 * j + b] = p[i] * p[j] * p[9 + of[a][b]];
    }

 private:
    template <class Sx>
    static void point(const Sx* x, const double* b, Sx* y) {
        for (int a = 0; a < 3; ++a) y[a] = x[a] * b[0] + x[3 + a] * b[1] + x[6 + a] * b[2];
    }
};

// (x - x0) . B (y - y0) of two nodes at x and y: what the second derivatives of a potential of many nodes couple. It
// has neither value nor force where the nodes are at x0 and y0.
struct PointCouplingElement {
    static constexpr int nodes = 2, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Places x0 and y0 [m], mixed second derivatives row by row [N/m].
    static std::vector<std::string> parameters() {
        return {"x0", "y0", "z0", "x1", "y1", "z1", "Bxx", "Bxy", "Bxz", "Byx", "Byy", "Byz", "Bzx", "Bzy", "Bzz"};
    }

    template <class SX, class Sx, class R>
    static void residual(const SX*, const Sx* x, const double* p, R* r) {
        Sx u[6];
        for (int a = 0; a < 6; ++a) u[a] = x[a] - p[a];
        for (int a = 0; a < 3; ++a) {
            r[a] = R(u[3] * p[6 + 3 * a] + u[4] * p[7 + 3 * a] + u[5] * p[8 + 3 * a]);
            r[3 + a] = R(u[0] * p[6 + a] + u[1] * p[9 + a] + u[2] * p[12 + a]);
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        Sx r[6], total(0.0);
        residual(X, x, p, r);
        for (int a = 0; a < 3; ++a) total += (x[a] - p[a]) * r[a];
        return Common<SX, Sx>(1.0) * total;
    }
};

}  // namespace restshape
