// Superconvergent patch recovery: nodal stresses from stresses that are constant on triangles.
//
// Around an inner node a linear polynomial is fitted to the values at the triangles' centres; a boundary node takes the
// mean of the polynomials of the inner nodes next to it. Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992)
// 1331.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

namespace restshape {

class PatchRecovery {
 public:
    using Value = Eigen::Array4d;

    // X (n, 2), cells (ne, stride) with corners first, values (ne, 4).
    PatchRecovery(const double* X, const int32_t* cells, int stride, const double* values, int n, int ne)
        : X_(X), cells_(cells), stride_(stride), values_(values), n_(n), ne_(ne), patches_(n) {}

    void run(double* out) {
        gather();
        for (Patch& p : patches_) p.fitted = p.balance == 0 && p.m[0] >= 3.0 && fit(p);
        extrapolate();
        spread(out);
    }

 private:
    struct Patch {
        Value b[3] = {Value::Zero(), Value::Zero(), Value::Zero()};  // moments of the values, then the polynomial
        Value sum = Value::Zero();                                   // of the neighbours' polynomials here
        double m[6] = {0, 0, 0, 0, 0, 0};                            // 1, x, y, xx, xy, yy
        int64_t balance = 0;  // 0 where triangles go all the way around: each neighbour follows and precedes one
        int count = 0;
        bool fitted = false;
    };

    const int32_t* cell(int e) const { return cells_ + static_cast<size_t>(e) * stride_; }
    const double* place(int a) const { return X_ + 2 * static_cast<size_t>(a); }

    void gather() {
        for (int e = 0; e < ne_; ++e) {
            const int32_t* c = cell(e);
            const Eigen::Map<const Value> value(values_ + 4 * static_cast<size_t>(e));
            const double *p = place(c[0]), *q = place(c[1]), *r = place(c[2]);
            const double cx = (p[0] + q[0] + r[0]) / 3.0, cy = (p[1] + q[1] + r[1]) / 3.0;
            for (int i = 0; i < 3; ++i) {
                Patch& patch = patches_[c[i]];
                const double x = cx - place(c[i])[0], y = cy - place(c[i])[1];
                patch.m[0] += 1.0, patch.m[1] += x, patch.m[2] += y;
                patch.m[3] += x * x, patch.m[4] += x * y, patch.m[5] += y * y;
                patch.b[0] += value, patch.b[1] += x * value, patch.b[2] += y * value;
                const int64_t after = c[(i + 1) % 3], before = c[(i + 2) % 3];
                patch.balance += after * (after + 1) - before * (before + 1);
            }
        }
    }

    // Least squares by the normal equations of the polynomial 1, x, y.
    static bool fit(Patch& p) {
        const double* m = p.m;
        const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5], c02 = m[1] * m[4] - m[2] * m[3];
        const double det = m[0] * c00 + m[1] * c01 + m[2] * c02;
        if (!(std::abs(det) > 1e-6 * m[0] * m[3] * m[5])) return false;
        const double c11 = m[0] * m[5] - m[2] * m[2], c12 = m[1] * m[2] - m[0] * m[4], c22 = m[0] * m[3] - m[1] * m[1];
        const Value r0 = p.b[0] / det, r1 = p.b[1] / det, r2 = p.b[2] / det;
        p.b[0] = c00 * r0 + c01 * r1 + c02 * r2;
        p.b[1] = c01 * r0 + c11 * r1 + c12 * r2;
        p.b[2] = c02 * r0 + c12 * r1 + c22 * r2;
        return true;
    }

    // Adds up, at nodes that have no polynomial, those of the neighbours that have one.
    void extrapolate() {
        for (int e = 0; e < ne_; ++e)
            for (int i = 0; i < 3; ++i) {
                const int to = cell(e)[i];
                if (patches_[to].fitted) continue;
                for (int j = 1; j < 3; ++j)
                    if (const int from = cell(e)[(i + j) % 3]; patches_[from].fitted) add(from, to);
            }
    }

    void add(int from, int to) {
        const Patch& p = patches_[from];
        const double x = place(to)[0] - place(from)[0], y = place(to)[1] - place(from)[1];
        patches_[to].sum += p.b[0] + x * p.b[1] + y * p.b[2];
        ++patches_[to].count;
    }

    void spread(double* out) {
        for (int a = 0; a < n_; ++a) {
            const Patch& p = patches_[a];
            Eigen::Map<Value> value(out + 4 * static_cast<size_t>(a));
            if (p.fitted)
                value = p.b[0];
            else if (p.count > 0)
                value = p.sum / p.count;
            else  // no inner node is near: the plain mean of the triangles around
                value = p.m[0] > 0.0 ? Value(p.b[0] / p.m[0]) : Value::Zero();
        }
    }

    const double* X_;
    const int32_t* cells_;
    int stride_;
    const double* values_;
    int n_, ne_;
    std::vector<Patch> patches_;
};

}  // namespace restshape
