// Superconvergent patch recovery for second-order triangles: nodal stresses from three samples a cell.
//
// Around an inner corner a quadratic polynomial is fitted to the samples of the cells there. A mid-side node takes the
// mean of the polynomials of its ends, a corner on the boundary (and a side between two of them) that of the inner
// corners of its cells; where there are none, linear fits of its own cells, or of its ends' cells.
// Source: Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992) 1331.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "fem/pack.hpp"
#include "fem/shapes.hpp"

namespace restshape {

class QuadraticPatchRecovery {
 public:
    using Value = Eigen::Array4d;
    using Samples = TriRule3;  // where cells are sampled

    // X (n, 2), cells (ne, 6), values (ne, samples, 4).
    QuadraticPatchRecovery(const double* X, const int32_t* cells, const double* values, int n, int ne)
        : X_(X), cells_(cells), values_(values), ne_(ne), nodes_(n) {}

    void run(double* out) {
        gather();
        fit_all();
        spread();
        for (const Node& node : nodes_) {
            Eigen::Map<Value> value(out);
            if (own(node))
                value = patches_[node.patch].b[0];
            else
                value = node.count != 0 ? Value(node.sum / node.count) : Value::Zero();
            out += 4;
        }
    }

 private:
    static constexpr int terms = 6, linear = 3;  // 1, x, y, xx, xy, yy
    static constexpr double enough = 1e-9;       // share of a pivot that is left where samples determine its term

    // The cells around a corner.
    struct Patch {
        EightLanes m[terms] = {};                                       // the lower triangle in the first lanes
        Value b[terms] = {Value::Zero(), Value::Zero(), Value::Zero(),  // moments of the values, then the polynomial
                          Value::Zero(), Value::Zero(), Value::Zero()};
        int64_t balance = 0;  // 0 where cells go all the way around: each neighbour follows and precedes one
        int rank = 1;
        bool quadratic = false;
    };
    struct Node {
        int patch = -1;             // of a corner
        Value sum = Value::Zero();  // of polynomials of neighbours, evaluated here
        int count = 0;
    };

    const int32_t* cell(int e) const { return cells_ + static_cast<size_t>(e) * 6; }
    const double* place(int a) const { return X_ + 2 * static_cast<size_t>(a); }
    bool quadratic(int corner) const { return patches_[nodes_[corner].patch].quadratic; }

    // Whether a node has the value of its own polynomial.
    bool own(const Node& node) const { return node.patch >= 0 && (patches_[node.patch].quadratic || node.count == 0); }

    static void monomials(double x, double y, double (&f)[terms]) {
        f[0] = 1.0, f[1] = x, f[2] = y, f[3] = x * x, f[4] = x * y, f[5] = y * y;
    }

    void gather() {
        patches_.reserve(nodes_.size() / 3);
        for (int e = 0; e < ne_; ++e) {
            const int32_t* c = cell(e);
            for (int i = 0; i < 3; ++i) {
                int& patch = nodes_[c[i]].patch;
                if (patch < 0) {
                    patch = static_cast<int>(patches_.size());
                    patches_.emplace_back();
                }
                const int64_t after = c[(i + 1) % 3], before = c[(i + 2) % 3];
                patches_[patch].balance += after * (after + 1) - before * (before + 1);
            }
        }
        static constexpr Table<Quadratic<2>, Samples> table{};
        for (int e = 0; e < ne_; ++e) {
            double at[Samples::points][2] = {};
            for (int s = 0; s < Samples::points; ++s)
                for (int i = 0; i < 6; ++i)
                    for (int a = 0; a < 2; ++a) at[s][a] += table.value[s][i] * place(cell(e)[i])[a];
            const double* values = values_ + static_cast<size_t>(e) * Samples::points * 4;
            for (int i = 0; i < 3; ++i) {
                const int corner = cell(e)[i];
                take(patches_[nodes_[corner].patch], place(corner), at, values);
            }
        }
    }

    // Adds the moments of a cell's samples, which stay in registers until all of them are added.
    static void take(Patch& p, const double* corner, const double (&at)[Samples::points][2], const double* values) {
        EightLanes m[terms];
        Value b[terms];
        std::copy_n(p.m, terms, m);
        std::copy_n(p.b, terms, b);
        for (int s = 0; s < Samples::points; ++s) {
            double f[terms];
            monomials(at[s][0] - corner[0], at[s][1] - corner[1], f);
            const EightLanes all = {f[0], f[1], f[2], f[3], f[4], f[5]};
            const Value value = Eigen::Map<const Value>(values + 4 * s);
            for (int i = 0; i < terms; ++i) {
                m[i] += f[i] * all;
                b[i] += f[i] * value;
            }
        }
        std::copy_n(m, terms, p.m);
        std::copy_n(b, terms, p.b);
    }

    // Several patches at once, one a lane, where cells go all the way around; the others one by one.
    void fit_all() {
        std::vector<Patch*> whole;
        for (Patch& p : patches_) {
            if (p.balance == 0)
                whole.push_back(&p);
            else
                factor(p), fit(p);
        }
        for (size_t first = 0; first < whole.size(); first += pack_lanes)
            fit_packed(&whole[first], std::min<size_t>(pack_lanes, whole.size() - first));
    }

    // Those whose samples do not determine a quadratic polynomial are left to `factor`.
    static void fit_packed(Patch* const* patches, size_t count) {
        Pack m[terms][terms], b[terms][Value::SizeAtCompileTime];
        for (int lane = 0; lane < pack_lanes; ++lane) {
            // Lanes beyond the last patch repeat it.
            const Patch& p = *patches[std::min<size_t>(lane, count - 1)];
            for (int i = 0; i < terms; ++i) {
                for (int j = 0; j <= i; ++j) m[i][j][lane] = p.m[i][j];
                for (int c = 0; c < p.b[i].size(); ++c) b[i][c][lane] = p.b[i][c];
            }
        }
        bool determined[pack_lanes];
        factor_packed(m, determined);
        for (int c = 0; c < Value::SizeAtCompileTime; ++c) {
            for (int i = 0; i < terms; ++i) {
                for (int j = 0; j < i; ++j) b[i][c] -= m[i][j] * b[j][c];
                b[i][c] /= m[i][i];
            }
            for (int i = terms - 1; i >= 0; --i) {
                for (int j = i + 1; j < terms; ++j) b[i][c] -= m[j][i] * b[j][c];
                b[i][c] /= m[i][i];
            }
        }
        for (size_t lane = 0; lane < count; ++lane) {
            Patch& p = *patches[lane];
            if (!determined[lane]) {
                factor(p), fit(p);
                continue;
            }
            for (int i = 0; i < terms; ++i)
                for (int c = 0; c < p.b[i].size(); ++c) p.b[i][c] = b[i][c][lane];
            p.quadratic = true;
            p.rank = terms;
        }
    }

    static void factor_packed(Pack (&m)[terms][terms], bool (&determined)[pack_lanes]) {
        std::fill_n(determined, pack_lanes, true);
        for (int rank = 0; rank < terms; ++rank) {
            Pack* row = m[rank];
            const Pack whole = row[rank];
            for (int j = 0; j < rank; ++j) {
                for (int k = 0; k < j; ++k) row[j] -= row[k] * m[j][k];
                row[j] /= m[j][j];
                row[rank] -= row[j] * row[j];
            }
            for (int lane = 0; lane < pack_lanes; ++lane)
                determined[lane] = determined[lane] && row[rank][lane] > enough * whole[lane];
            row[rank] = square_root(row[rank]);
        }
    }

    // Cholesky's factor of the least squares, whose first three rows are those of the linear polynomial.
    static void factor(Patch& p) {
        const int wanted = p.balance == 0 ? terms : linear;
        int rank = 0;
        for (; rank < wanted; ++rank) {
            EightLanes& row = p.m[rank];
            const double whole = row[rank];
            for (int j = 0; j < rank; ++j) {
                for (int k = 0; k < j; ++k) row[j] -= row[k] * p.m[j][k];
                row[j] /= p.m[j][j];
                row[rank] -= row[j] * row[j];
            }
            if (!(row[rank] > enough * whole)) break;
            row[rank] = std::sqrt(row[rank]);
        }
        p.quadratic = rank == terms;
        p.rank = p.quadratic ? terms : rank < linear ? 1 : linear;
    }

    // Moments become coefficients.
    static void fit(Patch& p) {
        for (int i = 0; i < p.rank; ++i) {
            for (int j = 0; j < i; ++j) p.b[i] -= p.m[i][j] * p.b[j];
            p.b[i] /= p.m[i][i];
        }
        for (int i = p.rank; i < terms; ++i) p.b[i].setZero();
        for (int i = p.rank - 1; i >= 0; --i) {
            for (int j = i + 1; j < p.rank; ++j) p.b[i] -= p.m[j][i] * p.b[j];
            p.b[i] /= p.m[i][i];
        }
    }

    // Evaluates the polynomials of corners at the other nodes where they count.
    void spread() {
        for (int e = 0; e < ne_; ++e) {
            const int32_t* c = cell(e);
            for (int i = 0; i < 3; ++i) {
                const int next = c[(i + 1) % 3], last = c[(i + 2) % 3], middle = c[3 + i];
                if (!quadratic(c[i])) {
                    if (quadratic(next)) evaluate(next, c[i]);
                    if (quadratic(last)) evaluate(last, c[i]);
                }
                if (quadratic(c[i])) evaluate(c[i], middle);
                if (quadratic(next)) evaluate(next, middle);
                if (!quadratic(c[i]) && !quadratic(next) && quadratic(last)) evaluate(last, middle);
            }
        }
        for (int e = 0; e < ne_; ++e)
            for (int i = 0; i < 3; ++i) {
                const int from = cell(e)[i], to = cell(e)[(i + 1) % 3], middle = cell(e)[3 + i];
                if (nodes_[middle].count > 0) continue;
                evaluate(from, middle);
                evaluate(to, middle);
            }
    }

    void evaluate(int from, int to) {
        const Patch& p = patches_[nodes_[from].patch];
        double f[terms];
        monomials(place(to)[0] - place(from)[0], place(to)[1] - place(from)[1], f);
        Node& here = nodes_[to];
        for (int i = 0; i < terms; ++i) here.sum += f[i] * p.b[i];
        ++here.count;
    }

    const double* X_;
    const int32_t* cells_;
    const double* values_;
    int ne_;
    std::vector<Node> nodes_;
    std::vector<Patch> patches_;
};

}  // namespace restshape
