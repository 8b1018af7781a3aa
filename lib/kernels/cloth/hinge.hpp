// Bending by the angle between two triangles: E = k/2 3 |e|^2/(A0 + A1) theta^2, all but theta at rest.
//
// For small angles it is the quadratic hinge of the same k. Source: Grinspun, Hirani, Desbrun and Schroeder, Discrete
// shells, Symp. Computer Animation (2003) 62; the gradient of theta: Tamstorf and Grinspun, Graphical Models 75 (2013)
// 362.
#pragma once

#include <string>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

// Nodes as in `HingeElement`.
struct NonlinearHingeElement {
    static constexpr int nodes = 4, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Stiffness [N m].
    static std::vector<std::string> parameters() { return {"k"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        Sx gradient[12];
        const Sx theta = angle(x, gradient);
        const R moment = theta * stiffness(X, p);
        for (int k = 0; k < 12; ++k) r[k] = gradient[k] * moment;
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        Sx gradient[12];
        const Sx theta = angle(x, gradient);
        return theta * theta * (0.5 * stiffness(X, p));
    }

 private:
    template <class S>
    static S stiffness(const S* X, const double* p) {
        S e[2], left[2], right[2];
        for (int a = 0; a < 2; ++a) {
            e[a] = X[2 + a] - X[a];
            left[a] = X[4 + a] - X[a];
            right[a] = X[6 + a] - X[a];
        }
        const S twice = e[0] * (left[1] - right[1]) - e[1] * (left[0] - right[0]);
        return (e[0] * e[0] + e[1] * e[1]) * (6 * p[0]) / twice;
    }

    template <class S>
    static S dot(const S* a, const S* b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    template <class S>
    static void cross(const S* a, const S* b, S* c) {
        for (int k = 0; k < 3; ++k) c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }

    // The angle between the normals, positive where the edge is a valley seen from their side, and its gradient.
    template <class S>
    static S angle(const S* x, S* gradient) {
        using std::atan2;
        using std::sqrt;
        S e[3], left[3], right[3], far_left[3], far_right[3], n[3], m[3], turn[3];
        for (int a = 0; a < 3; ++a) {
            e[a] = x[3 + a] - x[a];
            left[a] = x[6 + a] - x[a];
            right[a] = x[9 + a] - x[a];
            far_left[a] = x[6 + a] - x[3 + a];
            far_right[a] = x[9 + a] - x[3 + a];
        }
        cross(e, left, n);
        cross(right, e, m);
        cross(m, n, turn);
        const S length = sqrt(dot(e, e)), inverse = 1.0 / length;
        const S theta = atan2(dot(turn, e) * inverse, dot(n, m));
        const S nn = 1.0 / dot(n, n), mm = 1.0 / dot(m, m);
        const S l0 = dot(left, e) * inverse * nn, l1 = dot(far_left, e) * inverse * nn;
        const S r0 = dot(right, e) * inverse * mm, r1 = dot(far_right, e) * inverse * mm;
        for (int a = 0; a < 3; ++a) {
            gradient[a] = n[a] * l1 + m[a] * r1;
            gradient[3 + a] = -(n[a] * l0 + m[a] * r0);
            gradient[6 + a] = n[a] * (length * nn);
            gradient[9 + a] = m[a] * (length * mm);
        }
        return theta;
    }
};

}  // namespace restshape
