// A symmetric matrix in blocks of three unknowns a node, as its two halves: A = L + D + L^T.
//
// Rows of four numbers, the last one zero, take the place of a node's three: one register each. Sweeps read both halves
// rounded to single precision, which is most of what they fetch from memory; diagonal blocks and the residual are
// exact.
#pragma once

#include <petscsys.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace restshape {

using Row = Eigen::Array<double, 4, 1>;
using Rows = std::vector<Row, Eigen::aligned_allocator<Row>>;

class RelaxedMatrix {
 public:
    static constexpr double relaxation = 1.2;
    // What A is rounded by, over itself. Off the diagonal a row of elements' matrices is about as large as on it, for a
    // body that is only moved has no forces.
    static constexpr double rounding = 6e-8;

    // Takes in the pattern: block rows whose columns ascend. Returns whether each has its diagonal.
    bool set_pattern(PetscInt rows, const PetscInt* start, const PetscInt* column) {
        n_ = rows, start_ = start, column_ = column;
        diagonal_.resize(n_);
        own_.resize(3 * static_cast<std::size_t>(n_));
        inverse_.resize(own_.size());
        for (PetscInt i = 0; i < n_; ++i) {
            diagonal_[i] =
                static_cast<PetscInt>(std::lower_bound(column + start[i], column + start[i + 1], i) - column);
            if (diagonal_[i] == start[i + 1] || column[diagonal_[i]] != i) return false;
        }
        return true;
    }

    // Takes in the values, each block by columns. Returns whether all diagonal blocks are positive definite.
    bool set_values(const double* value) {
        value_ = value;
        const std::size_t count = 9 * static_cast<std::size_t>(start_[n_]);
        rounded_.resize(count);
        std::copy_n(value, count, rounded_.data());
        bool good = true;
        for (PetscInt i = 0; i < n_; ++i)
            good = set_diagonal(value + 9 * static_cast<std::size_t>(diagonal_[i]), i) && good;
        return good;
    }

    PetscInt rows() const { return n_; }

    // r = b - A x, from values that are not rounded.
    void residual(const Row* b, const Row* x, Row* r) const {
        for (PetscInt i = 0; i < n_; ++i) {
            const Row sum = less(b[i] - times(&own_[3 * i], x[i]), value_, start_[i], diagonal_[i], 1, x);
            r[i] = less(sum, value_, start_[i + 1] - 1, diagonal_[i], -1, x);
            r[i][3] = 0.0;
        }
    }

    // z with (D/w + L) y = r and z = D/w y; returns y . z, the square of r in the norm of the preconditioner.
    double lower_half(const Row* r, Row* y, Row* z) const {
        double square = 0.0;
        for (PetscInt i = 0; i < n_; ++i) {
            Row sum = less_lower(r[i], i, y);
            sum[3] = 0.0;
            z[i] = sum;
            y[i] = times(&inverse_[3 * i], sum);
            square += (y[i] * z[i]).sum();
        }
        return square;
    }

    // g = z + beta g, then p with (D/w + L^T) p = g.
    void upper_half(double beta, const Row* z, Row* g, Row* p) const {
        for (PetscInt i = n_; i-- > 0;) {
            g[i] = z[i] + beta * g[i];
            p[i] = times(&inverse_[3 * i], less_upper(g[i], i, p));
        }
    }

    // p . A p, and the square of D p.
    struct Sizes {
        double energy = 0.0, own = 0.0;
    };

    // With g of p as above: q = A p, and change = D/w (D/w + L)^-1 q; s is work.
    Sizes product(const Row* g, const Row* p, Row* s, Row* q, Row* change) const {
        constexpr double own = 1.0 - 1.0 / relaxation, other = 1.0 - 2.0 / relaxation;
        Sizes sizes;
        for (PetscInt i = 0; i < n_; ++i) {
            Row of_p[3] = {Row::Zero(), Row::Zero(), Row::Zero()}, of_s[3] = {Row::Zero(), Row::Zero(), Row::Zero()};
            for (PetscInt k = start_[i]; k < diagonal_[i]; ++k) {
                const float* block = rounded_.data() + 9 * static_cast<std::size_t>(k);
                const Row &pj = p[column_[k]], &sj = s[column_[k]];
                for (int c = 0; c < 3; ++c) {
                    const Row values = padded(block + 3 * c);
                    of_p[c] += values * pj[c];
                    of_s[c] += values * sj[c];
                }
            }
            const Row dp = times(&own_[3 * i], p[i]), rest = g[i] - (of_s[0] + of_s[1] + of_s[2]);
            s[i] = times(&inverse_[3 * i], rest + other * dp);
            Row product = g[i] + (of_p[0] + of_p[1] + of_p[2]) + own * dp, changed = rest + own * dp;
            product[3] = changed[3] = 0.0;
            q[i] = product;
            change[i] = changed;
            sizes.energy += (p[i] * product).sum();
            sizes.own += dp.square().sum();
        }
        return sizes;
    }

    // The square of z in the norm of (D/w)^-1, for one node.
    double square(PetscInt i, const Row& z) const { return (z * times(&inverse_[3 * i], z)).sum(); }

 private:
    // A node's own block, by padded columns.
    static Row times(const Row* columns, const Row& x) {
        return columns[0] * x[0] + columns[1] * x[1] + columns[2] * x[2];
    }

    // sum - A x over blocks from:to, the last first. The fourth number is one of the next column, and stays in its
    // lane: no block here is the last of the matrix. Each column has a sum of its own, for one waits for the one
    // before.
    template <class Value>
    Row less(const Row& sum, const Value* values, PetscInt from, PetscInt to, PetscInt step, const Row* x) const {
        Row sums[3] = {Row::Zero(), Row::Zero(), Row::Zero()};
        for (PetscInt k = from; k != to; k += step) {
            const Value* block = values + 9 * static_cast<std::size_t>(k);
            const Row& xj = x[column_[k]];
            for (int c = 0; c < 3; ++c) sums[c] += padded(block + 3 * c) * xj[c];
        }
        return sum - (sums[0] + sums[1] + sums[2]);
    }

    template <class Value>
    static Row padded(const Value* column) {
        return Eigen::Map<const Eigen::Array<Value, 4, 1>>(column).template cast<double>();
    }

    // Rows that a sweep has just come from are the last to be read.
    Row less_lower(const Row& sum, PetscInt i, const Row* x) const {
        return less(sum, rounded_.data(), start_[i], diagonal_[i], 1, x);
    }
    Row less_upper(const Row& sum, PetscInt i, const Row* x) const {
        return less(sum, rounded_.data(), start_[i + 1] - 1, diagonal_[i], -1, x);
    }

    // The inverse of D/w, by cofactors.
    bool set_diagonal(const double* d, PetscInt i) {
        const double xx = d[4] * d[8] - d[7] * d[7], xy = d[6] * d[7] - d[3] * d[8], xz = d[3] * d[7] - d[6] * d[4];
        const double determinant = d[0] * xx + d[3] * xy + d[6] * xz, scale = relaxation / determinant;
        const double yy = d[0] * d[8] - d[6] * d[6], yz = d[3] * d[6] - d[0] * d[7], zz = d[0] * d[4] - d[3] * d[3];
        Row *inverse = &inverse_[3 * i], *own = &own_[3 * i];
        for (int c = 0; c < 3; ++c) own[c] = {d[3 * c], d[3 * c + 1], d[3 * c + 2], 0.0};
        inverse[0] = {scale * xx, scale * xy, scale * xz, 0.0};
        inverse[1] = {scale * xy, scale * yy, scale * yz, 0.0};
        inverse[2] = {scale * xz, scale * yz, scale * zz, 0.0};
        return d[0] > 0.0 && zz > 0.0 && determinant > 0.0 && std::isfinite(scale);
    }

    PetscInt n_ = 0;
    const PetscInt *start_ = nullptr, *column_ = nullptr;
    const double* value_ = nullptr;
    std::vector<PetscInt> diagonal_;
    std::vector<float> rounded_;
    Rows own_, inverse_;  // of each node three columns: D, and w D^-1
};

}  // namespace restshape
