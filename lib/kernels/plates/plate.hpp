// Plates with shear: a triangle with the deflection and two rotations at each corner, isotropic or orthotropic.
//
// Along each side k, from corner i to j by the vector d, the rotation beta of the normal is linear plus 4 Li Lj a_k d,
// and the shear strain is constant. Kinematics and the balance of moment and shear force along the side give both from
//   c_k = w_j - w_i + d . (beta_i + beta_j)/2,   a_k = -3/2 c_k/(|d|^2 + 12 l^2),   g_k = 12 l^2 c_k/(|d|^2 + 12 l^2),
// where g_k = d . gamma and l^2 is bending over shear stiffness in the direction of the side. In thin plates g_k
// vanishes, in thick ones a_k does: nothing locks. Inside, gamma = sum of g_k (Li grad Lj - Lj grad Li). The deflection
// that belongs to it is cubic along sides, and inertia and loads take it.
// Source: Katili, Int. J. Numer. Meth. Engng 36 (1993) 1859 (DKMT); inertia by the deflection along sides is ours.
#pragma once

#include <string>
#include <vector>

#include "fem/mass.hpp"
#include "fem/shapes.hpp"

namespace restshape {

// What stiffness and inertia share. X are x, y and the thickness h of each corner; fields are the deflection w and the
// rotation vector (theta_x, theta_y): beta = (theta_y, -theta_x).
struct PlateParts {
    static constexpr int nodes = 3, dim = 3, fields = 3, unknowns = 9;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;
    static constexpr int rim = 11;  // the first of three parameters
    static constexpr double centre[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};

    // Stiffness in plane stress Q, shear moduli with their factor, density, load on the surface along z, and 1 for
    // each side that is free to twist: those without a neighbour, but for supports that hold the rotation along them.
    static std::vector<std::string> parameters() {
        return {"Q11", "Q12", "Q22", "Q16", "Q26", "Q66", "k44", "k45", "k55", "rho", "q", "rim01", "rim12", "rim20"};
    }

 protected:
    static constexpr int ends[3][2] = {{0, 1}, {1, 2}, {2, 0}};

    template <class S>
    struct Geometry {
        S G[3][2], twice_area;  // gradients of the barycentric coordinates
        S d[3][2], square[3];   // sides
        S bend[3], shear[3];    // a_k and g_k by c_k
    };

    template <class S>
    static void prepare(const S* X, const double* p, Geometry<S>& geometry) {
        auto& [G, twice_area, d, square, bend, shear] = geometry;
        for (int k = 0; k < 3; ++k)
            for (int a = 0; a < 2; ++a) d[k][a] = X[3 * ends[k][1] + a] - X[3 * ends[k][0] + a];
        twice_area = d[0][0] * d[1][1] - d[0][1] * d[1][0];
        const S inverse = 1.0 / twice_area;
        for (int i = 0; i < 3; ++i) {
            const int opposite = (i + 1) % 3;
            G[i][0] = -d[opposite][1] * inverse;
            G[i][1] = d[opposite][0] * inverse;
        }
        for (int k = 0; k < 3; ++k) {
            const S xx = d[k][0] * d[k][0], yy = d[k][1] * d[k][1], xy = d[k][0] * d[k][1];
            const S h = 0.5 * (X[3 * ends[k][0] + 2] + X[3 * ends[k][1] + 2]);
            square[k] = xx + yy;
            const S bending = xx * xx * p[0] + yy * yy * p[2] + (xx * yy) * (2 * (p[1] + 2 * p[5])) +
                              xy * (xx * (4 * p[3]) + yy * (4 * p[4]));
            const S shearing = (xx * p[8] + yy * p[6] + xy * (2 * p[7])) * square[k];
            const S length = (h * h) * bending / shearing;  // 12 l^2
            const S scale = 1.0 / (square[k] + length);
            bend[k] = -1.5 * scale;
            shear[k] = length * scale;
        }
    }

    // Rotation of the normal.
    template <class Sx>
    static Sx beta(const Sx* x, int i, int a) {
        return a == 0 ? x[3 * i + 2] : -x[3 * i + 1];
    }

    template <class SX, class Sx, class R>
    static void slips(const Geometry<SX>& g, const Sx* x, R (&c)[3]) {
        for (int k = 0; k < 3; ++k) {
            const int i = ends[k][0], j = ends[k][1];
            c[k] = x[3 * j] - x[3 * i] +
                   0.5 * ((beta(x, i, 0) + beta(x, j, 0)) * g.d[k][0] + (beta(x, i, 1) + beta(x, j, 1)) * g.d[k][1]);
        }
    }

    // What is conjugate to the unknowns: the corners' deflections and rotations, and the slips c.
    template <class R>
    struct Forces {
        R w[3], beta[3][2], c[3];

        Forces() {
            for (int i = 0; i < 3; ++i) w[i] = beta[i][0] = beta[i][1] = c[i] = R(0.0);
        }
    };

    template <class SX, class R>
    static void gather(const Geometry<SX>& g, Forces<R>& f, R* r) {
        for (int k = 0; k < 3; ++k) {
            const int i = ends[k][0], j = ends[k][1];
            f.w[i] -= f.c[k];
            f.w[j] += f.c[k];
            for (int a = 0; a < 2; ++a) {
                const R half = 0.5 * (f.c[k] * g.d[k][a]);
                f.beta[i][a] += half;
                f.beta[j][a] += half;
            }
        }
        for (int i = 0; i < 3; ++i) {
            r[3 * i] = f.w[i];
            r[3 * i + 1] = -f.beta[i][1];
            r[3 * i + 2] = f.beta[i][0];
        }
    }

    // Deflection at barycentric coordinates L.
    template <class SX, class Sx, class R>
    static R deflection(const Geometry<SX>& g, const double (&L)[3], const Sx* x, const R (&c)[3]) {
        R w = R(x[0] * L[0]) + x[3] * L[1] + x[6] * L[2];
        for (int k = 0; k < 3; ++k) {
            const int i = ends[k][0], j = ends[k][1];
            const double Lij = L[i] * L[j];
            w += ((beta(x, j, 0) - beta(x, i, 0)) * g.d[k][0] + (beta(x, j, 1) - beta(x, i, 1)) * g.d[k][1]) *
                 (0.5 * Lij);
            w += (g.bend[k] * g.square[k]) * c[k] * (2.0 / 3 * Lij * (L[i] - L[j]));
        }
        return w;
    }

    // Adds what a force along z at L does.
    template <class SX, class R, class F>
    static void push(const Geometry<SX>& g, const double (&L)[3], const F& force, Forces<R>& f) {
        for (int i = 0; i < 3; ++i) f.w[i] += force * L[i];
        for (int k = 0; k < 3; ++k) {
            const int i = ends[k][0], j = ends[k][1];
            const double Lij = L[i] * L[j];
            for (int a = 0; a < 2; ++a) {
                const F half = force * g.d[k][a] * (0.5 * Lij);
                f.beta[j][a] += half;
                f.beta[i][a] -= half;
            }
            f.c[k] += force * (g.bend[k] * g.square[k]) * (2.0 / 3 * Lij * (L[i] - L[j]));
        }
    }

    template <class S>
    static S thickness(const double (&L)[3], const S* X) {
        return X[2] * L[0] + X[5] * L[1] + X[8] * L[2];
    }

    template <class Rule>
    static void barycentric(int q, double (&L)[3]) {
        L[1] = Rule::at[q][0];
        L[2] = Rule::at[q][1];
        L[0] = 1.0 - L[1] - L[2];
    }
};

struct PlateElement : PlateParts {
    using Rule = TriRule6;  // bending of a linear thickness is of degree 5
    static constexpr int stress_components = 4;

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        Geometry<SX> g;
        prepare(X, p, g);
        R c[3];
        slips(g, x, c);
        Forces<R> f;
        for (int q = 0; q < Rule::points; ++q) {
            double L[3];
            barycentric<Rule>(q, L);
            const SX area = g.twice_area * Rule::weight[q], h = thickness(L, X);
            add_bending(g, L, x, c, (h * h * h) * area * (1.0 / 12), p, f);
            add_shear(g, L, c, h * area, p, f);
            push(g, L, area * -p[10], f);
        }
        for (int k = 0; k < 3; ++k)
            if (p[rim + k] != 0.0) add_rim(g, X, k, x, c, p, f);
        gather(g, f, r);
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        Geometry<SX> g;
        prepare(X, p, g);
        R c[3];
        slips(g, x, c);
        R total(0.0);
        for (int q = 0; q < Rule::points; ++q) {
            double L[3];
            barycentric<Rule>(q, L);
            const SX area = g.twice_area * Rule::weight[q], h = thickness(L, X);
            R kappa[3], m[3], gamma[2], force[2];
            curvature(g, L, x, c, kappa);
            moments(kappa, p, m);
            shear_strain(g, L, c, gamma);
            shear_force(gamma, p, force);
            const R bending = kappa[0] * m[0] + kappa[1] * m[1] + kappa[2] * m[2];
            total += bending * ((h * h * h) * area * (0.5 / 12));
            total += (gamma[0] * force[0] + gamma[1] * force[1]) * (h * area * 0.5);
            total -= deflection(g, L, x, c) * (area * p[10]);
        }
        for (int k = 0; k < 3; ++k)
            if (p[rim + k] != 0.0) total += rim_energy(g, X, k, x, c, p);
        return total;
    }

    // Moments xx yy xy a unit of length [N], and 0, at reference coordinates xi, the third of which is not looked at.
    static void stress(const double* X, const double* x, const double* p, const double* xi, double* s) {
        Geometry<double> g;
        prepare(X, p, g);
        double c[3], kappa[3], m[3];
        slips(g, x, c);
        const double L[3] = {1.0 - xi[0] - xi[1], xi[0], xi[1]}, h = thickness(L, X);
        curvature(g, L, x, c, kappa);
        moments(kappa, p, m);
        for (int a = 0; a < 3; ++a) s[a] = m[a] * (h * h * h) / 12;
        s[3] = 0.0;
    }

 private:
    // Gradient of 4 Li Lj.
    template <class SX>
    static void bubble(const Geometry<SX>& g, const double (&L)[3], int k, SX (&slope)[2]) {
        const int i = ends[k][0], j = ends[k][1];
        for (int a = 0; a < 2; ++a) slope[a] = g.G[j][a] * (4 * L[i]) + g.G[i][a] * (4 * L[j]);
    }

    // beta_x,x  beta_y,y  beta_x,y + beta_y,x
    template <class SX, class Sx, class R>
    static void curvature(const Geometry<SX>& g, const double (&L)[3], const Sx* x, const R (&c)[3], R (&kappa)[3]) {
        for (int a = 0; a < 3; ++a) kappa[a] = R(0.0);
        for (int i = 0; i < 3; ++i) {
            kappa[0] += beta(x, i, 0) * g.G[i][0];
            kappa[1] += beta(x, i, 1) * g.G[i][1];
            kappa[2] += beta(x, i, 0) * g.G[i][1] + beta(x, i, 1) * g.G[i][0];
        }
        for (int k = 0; k < 3; ++k) {
            SX s[2];
            bubble(g, L, k, s);
            const R a = c[k] * g.bend[k];
            kappa[0] += a * (g.d[k][0] * s[0]);
            kappa[1] += a * (g.d[k][1] * s[1]);
            kappa[2] += a * (g.d[k][0] * s[1] + g.d[k][1] * s[0]);
        }
    }

    template <class R>
    static void moments(const R (&kappa)[3], const double* p, R (&m)[3]) {
        m[0] = kappa[0] * p[0] + kappa[1] * p[1] + kappa[2] * p[3];
        m[1] = kappa[0] * p[1] + kappa[1] * p[2] + kappa[2] * p[4];
        m[2] = kappa[0] * p[3] + kappa[1] * p[4] + kappa[2] * p[5];
    }

    template <class SX, class Sx, class R, class W>
    static void add_bending(const Geometry<SX>& g, const double (&L)[3], const Sx* x, const R (&c)[3], const W& weight,
                            const double* p, Forces<R>& f) {
        R kappa[3], m[3];
        curvature(g, L, x, c, kappa);
        moments(kappa, p, m);
        for (int a = 0; a < 3; ++a) m[a] *= weight;
        bend(g, L, m, f);
    }

    // Adds what moments do to the curvature at L.
    template <class SX, class R>
    static void bend(const Geometry<SX>& g, const double (&L)[3], const R (&m)[3], Forces<R>& f) {
        for (int i = 0; i < 3; ++i) {
            f.beta[i][0] += m[0] * g.G[i][0] + m[2] * g.G[i][1];
            f.beta[i][1] += m[1] * g.G[i][1] + m[2] * g.G[i][0];
        }
        for (int k = 0; k < 3; ++k) {
            SX s[2];
            bubble(g, L, k, s);
            const R along =
                m[0] * (g.d[k][0] * s[0]) + m[1] * (g.d[k][1] * s[1]) + m[2] * (g.d[k][0] * s[1] + g.d[k][1] * s[0]);
            f.c[k] += along * g.bend[k];
        }
    }

    // Along a free side the twisting moment dies away within a layer of width delta, delta^2 being twist over shear
    // stiffness, which takes the energy delta m^2/(2 h^3/12 Q66) from a unit of length. A triangle of height t resolves
    // the share 1/(1 + t^2/(6 delta^2)) of it, by comparison with strips in torsion; the rest is taken here. With the
    // moment of the mean curvature a side takes at most delta/t 2/(1 + 6 delta^2/t^2) < 0.41 of the triangle's energy,
    // so that two of them leave it stiff.
    template <class SX>
    struct Rim {
        // The twisting moment, less what the moment across the side brings along, is v . m; -weight/2 its square, of
        // moments a unit of h^3/12, is the energy.
        SX v[3], weight;
    };

    template <class A, class B>
    static auto dot(const A (&a)[3], const B (&b)[3]) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    template <class SX>
    static Rim<SX> rim_of(const Geometry<SX>& g, const SX* X, int k, const double* p) {
        using std::sqrt;
        const SX xx = g.d[k][0] * g.d[k][0], yy = g.d[k][1] * g.d[k][1], xy = g.d[k][0] * g.d[k][1];
        const SX inverse = 1.0 / g.square[k], h = thickness(centre, X);
        Rim<SX> side{{-xy * inverse, xy * inverse, (xx - yy) * inverse}, SX(0.0)};
        // No moment and no force across the side change in the layer: where the grain is aslant the bending and the
        // shear across it give way.
        const SX across[3] = {yy * inverse, xx * inverse, -2 * xy * inverse};
        SX turned[3];
        moments(across, p, turned);
        const SX coupled = dot(side.v, turned) / dot(across, turned);
        for (int a = 0; a < 3; ++a) side.v[a] -= coupled * across[a];
        moments(side.v, p, turned);
        const SX twist = dot(side.v, turned);
        const SX along = xx * p[8] + yy * p[6] + xy * (2 * p[7]), normal = yy * p[8] + xx * p[6] - xy * (2 * p[7]);
        const SX mixed = xy * (p[8] - p[6]) + (yy - xx) * p[7], shear = (along - mixed * mixed / normal) * inverse;
        const SX width2 = (h * h) * twist / (12.0 * shear), height2 = g.twice_area * g.twice_area * inverse;
        const SX missing = sqrt(width2) * height2 / (height2 + 6.0 * width2);
        side.weight = missing * sqrt(g.square[k]) * (h * h * h) * (p[rim + k] / 12) / twist;
        return side;
    }

    template <class SX, class Sx, class R>
    static R rim_moment(const Geometry<SX>& g, const Rim<SX>& side, const Sx* x, const R (&c)[3], const double* p) {
        R kappa[3], m[3];
        curvature(g, centre, x, c, kappa);
        moments(kappa, p, m);
        return dot(m, side.v);
    }

    template <class SX, class Sx, class R>
    static void add_rim(const Geometry<SX>& g, const SX* X, int k, const Sx* x, const R (&c)[3], const double* p,
                        Forces<R>& f) {
        const Rim<SX> side = rim_of(g, X, k, p);
        const R twisting = rim_moment(g, side, x, c, p);
        SX turned[3];
        moments(side.v, p, turned);
        R m[3];
        for (int a = 0; a < 3; ++a) m[a] = -(twisting * (turned[a] * side.weight));
        bend(g, centre, m, f);
    }

    template <class SX, class Sx, class R>
    static R rim_energy(const Geometry<SX>& g, const SX* X, int k, const Sx* x, const R (&c)[3], const double* p) {
        const Rim<SX> side = rim_of(g, X, k, p);
        const R twisting = rim_moment(g, side, x, c, p);
        return (twisting * twisting) * (-0.5 * side.weight);
    }

    // Li grad Lj - Lj grad Li times g_k by c_k.
    template <class SX>
    static void whirl(const Geometry<SX>& g, const double (&L)[3], int k, SX (&v)[2]) {
        const int i = ends[k][0], j = ends[k][1];
        for (int a = 0; a < 2; ++a) v[a] = (g.G[j][a] * L[i] - g.G[i][a] * L[j]) * g.shear[k];
    }

    template <class SX, class R>
    static void shear_strain(const Geometry<SX>& g, const double (&L)[3], const R (&c)[3], R (&gamma)[2]) {
        gamma[0] = gamma[1] = R(0.0);
        for (int k = 0; k < 3; ++k) {
            SX v[2];
            whirl(g, L, k, v);
            for (int a = 0; a < 2; ++a) gamma[a] += c[k] * v[a];
        }
    }

    template <class R>
    static void shear_force(const R (&gamma)[2], const double* p, R (&force)[2]) {
        force[0] = gamma[0] * p[8] + gamma[1] * p[7];
        force[1] = gamma[0] * p[7] + gamma[1] * p[6];
    }

    template <class SX, class R, class W>
    static void add_shear(const Geometry<SX>& g, const double (&L)[3], const R (&c)[3], const W& weight,
                          const double* p, Forces<R>& f) {
        R gamma[2], force[2];
        shear_strain(g, L, c, gamma);
        shear_force(gamma, p, force);
        for (int a = 0; a < 2; ++a) force[a] *= weight;
        for (int k = 0; k < 3; ++k) {
            SX v[2];
            whirl(g, L, k, v);
            f.c[k] += force[0] * v[0] + force[1] * v[1];
        }
    }
};

// Inertia of the deflection and of the rotation; its energy is the kinetic energy when x is the velocity.
struct PlateMassElement : PlateParts {
    using Rule = TriRule12;  // exact where the thickness is constant: the square of a cubic

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        Geometry<SX> g;
        prepare(X, p, g);
        R c[3];
        slips(g, x, c);
        Forces<R> f;
        for (int q = 0; q < Rule::points; ++q) {
            double L[3];
            barycentric<Rule>(q, L);
            const SX h = thickness(L, X), mass = g.twice_area * h * (p[9] * Rule::weight[q]);
            const SX rotary = (h * h) * mass * (1.0 / 12);
            push(g, L, R(deflection(g, L, x, c) * mass), f);
            for (int a = 0; a < 2; ++a) {
                const R turn = rotation(g, L, x, c, a) * rotary;
                for (int i = 0; i < 3; ++i) f.beta[i][a] += turn * L[i];
                for (int k = 0; k < 3; ++k) f.c[k] += turn * (g.bend[k] * g.d[k][a] * bump(L, k));
            }
        }
        gather(g, f, r);
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        return inertial_energy<PlateMassElement>(X, x, p);
    }

 private:
    static double bump(const double (&L)[3], int k) { return 4 * L[ends[k][0]] * L[ends[k][1]]; }

    template <class SX, class Sx, class R>
    static R rotation(const Geometry<SX>& g, const double (&L)[3], const Sx* x, const R (&c)[3], int a) {
        R turn = R(beta(x, 0, a) * L[0]) + beta(x, 1, a) * L[1] + beta(x, 2, a) * L[2];
        for (int k = 0; k < 3; ++k) turn += c[k] * (g.bend[k] * g.d[k][a] * bump(L, k));
        return turn;
    }
};

}  // namespace restshape
