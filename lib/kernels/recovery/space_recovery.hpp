// Patch recovery for tetrahedra: nodal stresses from samples in the cells, by polynomials of the cells' own order.
//
// Each corner has a polynomial of its own, on the boundary too, for bodies of one layer have no inner nodes. It is
// fitted to the samples of the cells around the corner. A mid-side node takes the mean of the polynomials of its ends.
//
// Few cells around a corner may determine a polynomial badly: their centres lie near a plane, their samples near a
// quadric. A recovered value is a weighted sum of samples, and the sum of the squared weights says by how much it
// magnifies the samples' errors. It is bounded: a node where it would be larger takes the mean of the polynomials
// that its cells' other corners have, where these are within the bound; where none is, it takes what its own cells
// determine, to a lower degree. Source: after Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992) 1331.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

// Fits on one mesh to any number of stresses.
template <class Basis, class Samples>
class SpaceRecovery {
 public:
    static constexpr int nodes = Basis::nodes, corners = 4, values = 6, points = Samples::points;
    static constexpr int terms = Basis::order == 1 ? 4 : 10;  // 1, x, y, z, and their products
    using Value = Eigen::Array<double, values, 1>;

    // X (n, 3), cells (ne, nodes), stress (count, ne, points, 6).
    SpaceRecovery(const double* X, const int32_t* cells, std::ptrdiff_t n, std::ptrdiff_t ne, const double* stress,
                  std::ptrdiff_t count)
        : X_(X), cells_(cells), n_(n), ne_(ne), patch_(n, -1) {
        int count_of_patches = 0;
        for (std::ptrdiff_t e = 0; e < ne_; ++e)
            for (int i = 0; i < corners; ++i)
                if (int& patch = patch_[cell(e)[i]]; patch < 0) patch = count_of_patches++;
        patches_.resize(count_of_patches);
        sources_.reserve(n_);
        for (std::ptrdiff_t e = 0; e < ne_; ++e) measure(cell(e));
        for (Patch& p : patches_) p.inverse = 1.0 / std::sqrt(p.inverse);
        moments_.resize(count * patches_.size());
        visit([this, stress, count](int patch, const double(&f)[terms], std::ptrdiff_t sample) {
            Patch& p = patches_[patch];
            using Row = Eigen::Array<double, terms, 1>;
            for (int k = 0; k < terms; ++k) Eigen::Map<Row>(p.m[k]) += f[k] * Eigen::Map<const Row>(f);
            for (std::ptrdiff_t s = 0; s < count; ++s) {
                const Value value = Eigen::Map<const Value>(stress + values * (s * ne_ * points + sample));
                Moments& moments = moments_[s * patches_.size() + patch];
                for (int k = 0; k < terms; ++k) moments.b[k] += f[k] * value;
            }
        });
        for (Patch& p : patches_) factor(p);
        choose();
        for (std::ptrdiff_t s = 0; s < count; ++s)
            for (size_t p = 0; p < patches_.size(); ++p) solve(patches_[p], moments_[s * patches_.size() + p]);
    }

    // The nodal values of the stress of that number, out (n, 6).
    void write(std::ptrdiff_t number, double* out) const {
        const Moments* moments = moments_.data() + number * patches_.size();
        std::fill(out, out + values * n_, 0.0);
        for (const Source& s : sources_) {
            Eigen::Map<Value> value(out + values * static_cast<size_t>(s.node));
            for (int k = 0; k < s.rank; ++k) value += s.share * s.p[k] * moments[s.patch].b[k];
        }
    }

 private:
    static constexpr int linear = 4;
    // Of the sum of the squared weights. In well shaped patches with no more samples than terms it is up to about 12.
    static constexpr double most = 16.0;

    struct Patch {
        double m[terms][terms] = {};  // normal equations; below, then, their factor with the diagonal's reciprocals
        double inverse = 0.0;         // of the length of its longest side
        int rank = 0;                 // terms that are determined: 1, 4 or 10
    };
    // A part of a node's value: the polynomial of a patch there, times a share.
    struct Source {
        int32_t node;
        int patch, rank;
        double share, p[terms];  // of the patch's orthonormal polynomials, their values at the node
    };
    struct Moments {
        Value b[terms];
        Moments() {
            for (Value& moment : b) moment.setZero();
        }
    };

    const int32_t* cell(std::ptrdiff_t e) const { return cells_ + e * nodes; }
    const double* place(int32_t a) const { return X_ + 3 * static_cast<size_t>(a); }

    // The squares of the longest sides of patches, as far as a cell has them.
    void measure(const int32_t* cell) {
        for (int i = 0; i < corners; ++i)
            for (int j = 0; j < i; ++j) {
                double square = 0.0;
                for (int a = 0; a < 3; ++a) {
                    const double d = place(cell[j])[a] - place(cell[i])[a];
                    square += d * d;
                }
                for (const int end : {i, j}) {
                    Patch& p = patches_[patch_[cell[end]]];
                    p.inverse = std::max(p.inverse, square);
                }
            }
    }

    // Of a place relative to the corner, over the patch's size, so that all terms are alike.
    void monomials(int32_t corner, const double* at, double (&f)[terms]) const {
        const double inverse = patches_[patch_[corner]].inverse;
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

    // Cholesky's factor of the normal equations, as far as rounding allows.
    static void factor(Patch& p) {
        int k = 0;
        for (; k < terms; ++k) {
            double* row = p.m[k];
            const double whole = row[k];
            for (int j = 0; j < k; ++j) {
                for (int l = 0; l < j; ++l) row[j] -= row[l] * p.m[j][l];
                row[j] *= p.m[j][j];
                row[k] -= row[j] * row[j];
            }
            if (!(row[k] > 1e-9 * whole)) break;
            row[k] = 1.0 / std::sqrt(row[k]);
        }
        p.rank = k == terms ? terms : k >= linear ? linear : 1;
    }

    // Turns moments of the stress to coefficients of the patch's orthonormal polynomials. A fit of lower degree has
    // the first of them.
    static void solve(const Patch& p, Moments& moments) {
        Value* b = moments.b;
        for (int k = 0; k < p.rank; ++k) {
            for (int j = 0; j < k; ++j) b[k] -= p.m[k][j] * b[j];
            b[k] *= p.m[k][k];
        }
    }

    // The polynomial of corner `from` at node `to`, of the highest degree whose weights are bounded.
    Source source(int32_t from, int32_t to) const {
        Source found{to, patch_[from], 1, 1.0, {}};
        const Patch& p = patches_[found.patch];
        monomials(from, place(to), found.p);
        double weights = 0.0;
        for (int k = 0; k < p.rank; ++k) {
            for (int j = 0; j < k; ++j) found.p[k] -= p.m[k][j] * found.p[j];
            found.p[k] *= p.m[k][k];
            weights += found.p[k] * found.p[k];
            if (weights > most) break;
            if (k + 1 == linear || k + 1 == terms) found.rank = k + 1;
        }
        return found;
    }

    // Corners whose polynomials a node of a cell takes first: itself, or the ends of its side.
    static std::pair<int, int> own(int i) {
        if constexpr (Basis::order == 2)
            if (i >= corners) return {Basis::sides[i - corners][0], Basis::sides[i - corners][1]};
        return {i, i};
    }

    // Where each node has its value from.
    void choose() {
        std::vector<int> count(n_, -1);
        const auto take = [&](int32_t from, int32_t to, int least) {
            const Source found = source(from, to);
            if (found.rank < least) return;
            sources_.push_back(found);
            ++count[to];
        };
        // Each node as the first of its cells has it, for the ends of a side are the same in all.
        const auto take_own = [&](std::ptrdiff_t e, int i, int least) {
            const auto [first, second] = own(i);
            take(cell(e)[first], cell(e)[i], least);
            if (second != first) take(cell(e)[second], cell(e)[i], least);
        };
        for (std::ptrdiff_t e = 0; e < ne_; ++e)
            for (int i = 0; i < nodes; ++i)
                if (int& here = count[cell(e)[i]]; here < 0) here = 0, take_own(e, i, terms);
        std::vector<bool> poor(n_);
        for (std::ptrdiff_t a = 0; a < n_; ++a) poor[a] = count[a] == 0;
        for (std::ptrdiff_t e = 0; e < ne_; ++e)
            for (int i = 0; i < nodes; ++i) {
                if (!poor[cell(e)[i]]) continue;
                const auto [first, second] = own(i);
                for (int j = 0; j < corners; ++j)
                    if (j != first && j != second) take(cell(e)[j], cell(e)[i], terms);
            }
        for (std::ptrdiff_t e = 0; e < ne_; ++e)
            for (int i = 0; i < nodes; ++i)
                if (count[cell(e)[i]] == 0) take_own(e, i, 1);
        for (Source& s : sources_) s.share = 1.0 / count[s.node];
    }

    const double* X_;
    const int32_t* cells_;
    std::ptrdiff_t n_, ne_;
    std::vector<int> patch_;  // of each node that is a corner
    std::vector<Patch> patches_;
    std::vector<Source> sources_;
    std::vector<Moments> moments_;
};

}  // namespace restshape
