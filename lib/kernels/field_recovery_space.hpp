// Patch recovery for tetrahedra: nodal stresses from samples in the cells, by polynomials of the cells' own order.
//
// Each corner has a polynomial of its own, on the boundary too, for bodies of one layer have no inner nodes. It is
// fitted to the samples of the cells around the corner; terms that these do not determine are left out. A mid-side node
// takes the mean of the polynomials of its ends. Source: after Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33
// (1992) 1331.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "shapes.hpp"

namespace restshape {

// Fits on one mesh for any number of stresses.
template <class Basis, class Samples>
class SpaceRecovery {
 public:
    static constexpr int nodes = Basis::nodes, corners = 4, values = 6, points = Samples::points;
    static constexpr int terms = Basis::order == 1 ? 4 : 10;  // 1, x, y, z, and their products
    using Value = Eigen::Array<double, values, 1>;

    // X (n, 3), cells (ne, nodes).
    SpaceRecovery(const double* X, const int32_t* cells, std::ptrdiff_t n, std::ptrdiff_t ne)
        : X_(X), cells_(cells), n_(n), ne_(ne), patch_(n, -1) {
        for (std::ptrdiff_t e = 0; e < ne_; ++e)
            for (int i = 0; i < corners; ++i) {
                int& patch = patch_[cell(e)[i]];
                if (patch < 0) {
                    patch = static_cast<int>(patches_.size());
                    patches_.emplace_back();
                }
                for (int j = 0; j < corners; ++j) {
                    double square = 0.0;
                    for (int a = 0; a < 3; ++a) {
                        const double d = place(cell(e)[j])[a] - place(cell(e)[i])[a];
                        square += d * d;
                    }
                    patches_[patch].size = std::max(patches_[patch].size, square);
                }
            }
        for (Patch& p : patches_) p.size = std::sqrt(p.size);
        visit([this](int patch, const double(&f)[terms], std::ptrdiff_t) {
            Patch& p = patches_[patch];
            for (int k = 0; k < terms; ++k)
                for (int l = 0; l <= k; ++l) p.m[k][l] += f[k] * f[l];
        });
        for (Patch& p : patches_) factor(p);
    }

    // stress (ne, points, 6), out (n, 6).
    void run(const double* stress, double* out) {
        moments_.assign(patches_.size(), Moments{});
        visit([this, stress](int patch, const double(&f)[terms], std::ptrdiff_t sample) {
            const Eigen::Map<const Value> value(stress + values * sample);
            for (int k = 0; k < terms; ++k) moments_[patch].b[k] += f[k] * value;
        });
        for (size_t p = 0; p < patches_.size(); ++p) solve(patches_[p], moments_[p]);
        std::vector<int> count(n_, 0);
        std::fill(out, out + values * n_, 0.0);
        for (std::ptrdiff_t a = 0; a < n_; ++a)
            if (patch_[a] >= 0) Eigen::Map<Value>(out + values * a) = moments_[patch_[a]].b[0];
        if constexpr (Basis::order == 2) {
            for (std::ptrdiff_t e = 0; e < ne_; ++e)
                for (int m = 0; m < nodes - corners; ++m)
                    for (const int end : Basis::sides[m]) {
                        const int32_t to = cell(e)[corners + m];
                        Eigen::Map<Value>(out + values * static_cast<size_t>(to)) += value(cell(e)[end], to);
                        ++count[to];
                    }
            for (std::ptrdiff_t a = 0; a < n_; ++a)
                if (count[a]) Eigen::Map<Value>(out + values * a) /= count[a];
        }
    }

 private:
    struct Patch {
        double m[terms][terms] = {};
        double size = 0.0;
        bool kept[terms] = {};
    };
    struct Moments {
        Value b[terms];
        Moments() {
            for (Value& moment : b) moment.setZero();
        }
    };

    const int32_t* cell(std::ptrdiff_t e) const { return cells_ + e * nodes; }
    const double* place(int32_t a) const { return X_ + 3 * static_cast<size_t>(a); }

    // Of a place relative to the corner, over the patch's size, so that all terms are alike.
    void monomials(int32_t corner, const double* at, double (&f)[terms]) const {
        const double inverse = 1.0 / patches_[patch_[corner]].size;
        double d[3];
        for (int a = 0; a < 3; ++a) d[a] = (at[a] - place(corner)[a]) * inverse;
        f[0] = 1.0;
        for (int a = 0; a < 3; ++a) f[1 + a] = d[a];
        if constexpr (terms == 10) {
            int k = 4;
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b <= a; ++b) f[k++] = d[a] * d[b];
        }
    }

    // Each sample as each corner of its cell sees it.
    template <class Take>
    void visit(Take take) const {
        static constexpr Table<Basis, Samples> table{};
        for (std::ptrdiff_t e = 0; e < ne_; ++e)
            for (int s = 0; s < points; ++s) {
                double at[3] = {0.0, 0.0, 0.0};
                for (int i = 0; i < nodes; ++i)
                    for (int a = 0; a < 3; ++a) at[a] += table.value[s][i] * place(cell(e)[i])[a];
                for (int i = 0; i < corners; ++i) {
                    double f[terms];
                    monomials(cell(e)[i], at, f);
                    take(patch_[cell(e)[i]], f, e * points + s);
                }
            }
    }

    // Cholesky's factor of the normal equations, without the terms that those before them determine already.
    static void factor(Patch& p) {
        for (int k = 0; k < terms; ++k) {
            double* row = p.m[k];
            const double whole = row[k];
            for (int j = 0; j < k; ++j) {
                if (!p.kept[j]) continue;
                for (int l = 0; l < j; ++l)
                    if (p.kept[l]) row[j] -= row[l] * p.m[j][l];
                row[j] /= p.m[j][j];
                row[k] -= row[j] * row[j];
            }
            p.kept[k] = row[k] > 1e-6 * whole;
            if (p.kept[k]) row[k] = std::sqrt(row[k]);
        }
    }

    // Turns moments of the stress to the polynomial.
    static void solve(const Patch& p, Moments& moments) {
        Value* b = moments.b;
        for (int k = 0; k < terms; ++k) {
            if (!p.kept[k]) {
                b[k].setZero();
                continue;
            }
            for (int j = 0; j < k; ++j) b[k] -= p.m[k][j] * b[j];
            b[k] /= p.m[k][k];
        }
        for (int k = terms - 1; k >= 0; --k) {
            if (!p.kept[k]) continue;
            for (int j = k + 1; j < terms; ++j)
                if (p.kept[j]) b[k] -= p.m[j][k] * b[j];
            b[k] /= p.m[k][k];
        }
    }

    Value value(int32_t from, int32_t to) const {
        double f[terms];
        monomials(from, place(to), f);
        Value sum = Value::Zero();
        for (int k = 0; k < terms; ++k) sum += f[k] * moments_[patch_[from]].b[k];
        return sum;
    }

    const double* X_;
    const int32_t* cells_;
    std::ptrdiff_t n_, ne_;
    std::vector<int> patch_;  // of each node that is a corner
    std::vector<Patch> patches_;
    std::vector<Moments> moments_;
};

}  // namespace restshape
