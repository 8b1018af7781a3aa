// Geometric stiffness of a solid under the stress of a small displacement u: energy 1/2 int sigma(u) : H^T H for the
// displacement gradient H of x: what sigma does when parts of the body turn (docs/theory/buckling.md).
#pragma once

#include <string>
#include <vector>

#include "elasticity/solid_parts.hpp"

namespace restshape {

// `Mean`: the dilatation of u is its mean over the element, as in DilatationElement.
template <class Shape, bool Mean>
struct GeometricElement : SolidParts<Shape> {
    using Parts = SolidParts<Shape>;
    using Parts::dim;
    using Parts::nodes;
    using Parts::unknowns;
    static constexpr int stress_components = 0;
    static constexpr int displacement = 3;  // where u begins among the parameters
    static_assert(dim == 2, "parameters are those of plane solids");

    static std::vector<std::string> parameters() {
        std::vector<std::string> names = {"lambda", "mu", "thickness"};
        for (int i = 0; i < nodes; ++i)
            for (const char* axis : {"x", "y"}) names.push_back("u" + std::to_string(i) + axis);
        return names;
    }

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        const SX mean = mean_dilatation(X, p);
        for (int k = 0; k < unknowns; ++k) r[k] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim], N[dim][dim];
            R H[dim][dim];
            stress(q, X, p, mean, G, N);
            Parts::displacement_gradient(G, x, H);
            for (int i = 0; i < nodes; ++i) {
                SX pull[dim];
                along(N, G[i], pull);
                for (int a = 0; a < dim; ++a)
                    for (int k = 0; k < dim; ++k) r[i * dim + a] += H[a][k] * pull[k];
            }
        }
    }

    [[gnu::flatten]] static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        constexpr int stride = Dual<unknowns>::lanes;
        residual(X, x, p, r);
        for (int k = 0; k < unknowns * stride; ++k) K[k] = 0.0;
        const double mean = mean_dilatation(X, p);
        for (int q = 0; q < Shape::points; ++q) {
            double G[nodes][dim], N[dim][dim];
            stress(q, X, p, mean, G, N);
            for (int i = 0; i < nodes; ++i) {
                double pull[dim];
                along(N, G[i], pull);
                for (int j = 0; j < nodes; ++j) {
                    double share = pull[0] * G[j][0];
                    for (int k = 1; k < dim; ++k) share += pull[k] * G[j][k];
                    for (int a = 0; a < dim; ++a) K[(i * dim + a) * stride + j * dim + a] += share;
                }
            }
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R total(0.0);
        const SX mean = mean_dilatation(X, p);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim], N[dim][dim];
            R H[dim][dim];
            stress(q, X, p, mean, G, N);
            Parts::displacement_gradient(G, x, H);
            for (int a = 0; a < dim; ++a)
                for (int k = 0; k < dim; ++k)
                    for (int l = 0; l < dim; ++l) total += 0.5 * (H[a][k] * (H[a][l] * N[k][l]));
        }
        return total;
    }

 private:
    template <class SX>
    static void along(const SX (&N)[dim][dim], const SX (&G)[dim], SX (&pull)[dim]) {
        for (int k = 0; k < dim; ++k) {
            pull[k] = N[k][0] * G[0];
            for (int l = 1; l < dim; ++l) pull[k] += N[k][l] * G[l];
        }
    }

    // Gradients of the basis at point q, and the stress of u there times the volume that the point stands for.
    template <class SX>
    static void stress(int q, const SX* X, const double* p, const SX& mean, SX (&G)[nodes][dim], SX (&N)[dim][dim]) {
        const SX volume = Shape::gradients(q, X, G) * p[2];
        SX H[dim][dim], E[dim][dim];
        Parts::displacement_gradient(G, p + displacement, H);
        LinearElastic<dim>::strain(H, E);
        hooke(E, SX((Mean ? mean : trace(E)) * p[0]), p[1], N);
        for (int k = 0; k < dim; ++k)
            for (int l = 0; l < dim; ++l) N[k][l] *= volume;
    }

    template <class SX>
    static SX mean_dilatation(const SX* X, const double* p) {
        SX integral(0.0), whole(0.0);
        for (int q = 0; Mean && q < Shape::points; ++q) {
            SX G[nodes][dim], H[dim][dim];
            const SX volume = Shape::gradients(q, X, G);
            Parts::displacement_gradient(G, p + displacement, H);
            integral += trace(H) * volume;
            whole += volume;
        }
        return Mean ? SX(integral / whole) : integral;
    }
};

}  // namespace restshape
