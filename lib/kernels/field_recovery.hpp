// Superconvergent patch recovery: nodal values from values that are constant on triangles.
//
// Around an inner node a linear polynomial is fitted to the values at the triangles' centres; a boundary node takes the
// mean of the polynomials of the inner nodes next to it. Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992) 1331.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace restshape {

struct TriangleField {
    const double* X;       // (n, 2)
    const int32_t* cells;  // (ne, stride), corners first
    const double* values;  // (ne, k)
    int n, ne, stride, k;
};

class PatchRecovery {
  public:
    explicit PatchRecovery(const TriangleField& field) : f_(field), start_(field.n + 1, 0), around_(3 * field.ne) {
        for (int e = 0; e < f_.ne; ++e)
            for (int i = 0; i < 3; ++i) ++start_[corner(e, i) + 1];
        for (int a = 0; a < f_.n; ++a) start_[a + 1] += start_[a];
        std::vector<int> next(start_.begin(), start_.end() - 1);
        for (int e = 0; e < f_.ne; ++e)
            for (int i = 0; i < 3; ++i) around_[next[corner(e, i)]++] = e;
        fit_.assign(static_cast<size_t>(f_.n) * 3 * f_.k, 0.0);
        fitted_.assign(f_.n, 0);
    }

    void run(double* out) {
        for (int a = 0; a < f_.n; ++a)
            if (closed(a)) fitted_[a] = fit(a);
        for (int a = 0; a < f_.n; ++a) {
            double* value = out + static_cast<size_t>(a) * f_.k;
            if (fitted_[a])
                for (int j = 0; j < f_.k; ++j) value[j] = coefficients(a)[j];
            else if (!from_neighbours(a, value))
                mean(a, value);
        }
    }

  private:
    int corner(int e, int i) const { return f_.cells[static_cast<size_t>(e) * f_.stride + i]; }
    const double* place(int a) const { return f_.X + 2 * static_cast<size_t>(a); }
    double* coefficients(int a) { return fit_.data() + static_cast<size_t>(a) * 3 * f_.k; }

    // Whether triangles go all the way around a node: then each neighbour follows, and precedes, another one.
    bool closed(int a) const {
        int64_t balance = 0;
        for (int s = start_[a]; s < start_[a + 1]; ++s) {
            const int e = around_[s], i = position(e, a);
            const int64_t after = corner(e, (i + 1) % 3), before = corner(e, (i + 2) % 3);
            balance += after * (after + 1) - before * (before + 1);
        }
        return balance == 0 && start_[a + 1] - start_[a] >= 3;
    }

    int position(int e, int a) const { return corner(e, 0) == a ? 0 : corner(e, 1) == a ? 1 : 2; }

    bool fit(int a) {
        const double* x0 = place(a);
        double m[6] = {0, 0, 0, 0, 0, 0}, scale = 0.0;
        double* b = coefficients(a);
        for (int s = start_[a]; s < start_[a + 1]; ++s) {
            double d[2];
            centre(around_[s], x0, d);
            const double* value = f_.values + static_cast<size_t>(around_[s]) * f_.k;
            m[0] += 1.0, m[1] += d[0], m[2] += d[1], m[3] += d[0] * d[0], m[4] += d[0] * d[1], m[5] += d[1] * d[1];
            for (int j = 0; j < f_.k; ++j) {
                b[j] += value[j];
                b[f_.k + j] += d[0] * value[j];
                b[2 * f_.k + j] += d[1] * value[j];
            }
        }
        scale = m[0] * m[3] * m[5];
        const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5], c02 = m[1] * m[4] - m[2] * m[3];
        const double det = m[0] * c00 + m[1] * c01 + m[2] * c02;
        if (!(std::abs(det) > 1e-6 * scale)) return false;
        const double c11 = m[0] * m[5] - m[2] * m[2], c12 = m[1] * m[2] - m[0] * m[4], c22 = m[0] * m[3] - m[1] * m[1];
        for (int j = 0; j < f_.k; ++j) {
            const double r0 = b[j], r1 = b[f_.k + j], r2 = b[2 * f_.k + j];
            b[j] = (c00 * r0 + c01 * r1 + c02 * r2) / det;
            b[f_.k + j] = (c01 * r0 + c11 * r1 + c12 * r2) / det;
            b[2 * f_.k + j] = (c02 * r0 + c12 * r1 + c22 * r2) / det;
        }
        return true;
    }

    void centre(int e, const double* from, double* d) const {
        for (int c = 0; c < 2; ++c)
            d[c] = (place(corner(e, 0))[c] + place(corner(e, 1))[c] + place(corner(e, 2))[c]) / 3.0 - from[c];
    }

    bool from_neighbours(int a, double* value) {
        std::fill(value, value + f_.k, 0.0);
        int count = 0;
        for (int s = start_[a]; s < start_[a + 1]; ++s)
            for (int i = 0; i < 3; ++i) {
                const int b = corner(around_[s], i);
                if (b == a || !fitted_[b]) continue;
                const double dx = place(a)[0] - place(b)[0], dy = place(a)[1] - place(b)[1];
                const double* p = coefficients(b);
                for (int j = 0; j < f_.k; ++j) value[j] += p[j] + dx * p[f_.k + j] + dy * p[2 * f_.k + j];
                ++count;
            }
        for (int j = 0; j < f_.k && count; ++j) value[j] /= count;
        return count > 0;
    }

    void mean(int a, double* value) const {
        std::fill(value, value + f_.k, 0.0);
        const int count = start_[a + 1] - start_[a];
        for (int s = start_[a]; s < start_[a + 1]; ++s)
            for (int j = 0; j < f_.k; ++j) value[j] += f_.values[static_cast<size_t>(around_[s]) * f_.k + j] / count;
    }

    TriangleField f_;
    std::vector<int> start_, around_;
    std::vector<double> fit_;
    std::vector<uint8_t> fitted_;
};

}  // namespace restshape
