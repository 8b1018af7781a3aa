// The matrix of one grid of a multigrid cycle: a symmetric one in single precision, of which each sweep reads one half.
//
// A = L + D + L^T of a rank's own nodes, C couples them with nodes of other ranks. Sweeps are Gauss and Seidel's of the
// rank's own rows. On the diagonal they add half of the sums of C's magnitudes, with which they converge whatever the
// ranks are: A. H. Baker, R. D. Falgout, T. V. Kolev and U. M. Yang, SIAM J. Sci. Comput. 33 (2011), 2864.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "algebra/single_blocks.hpp"

namespace restshape {

struct GridMatrix {
    virtual ~GridMatrix() = default;

    // Takes in the rank's own rows, and those of C, whose columns stand at `place` among the ghosts' unknowns.
    virtual void set(const StoredRows& own, const StoredRows& coupling, const std::vector<PetscInt>& place) = 0;

    // From x = 0 a sweep down the rows: x, and r = b - A x but for what C gives.
    virtual void down(const double* b, double* x, double* r) const = 0;

    // r -= C ghosts.
    virtual void couple(const double* ghosts, double* r) const = 0;

    // Adds a change to x, then a sweep up the rows. r is the residual before the change, but has lost what C gives of
    // it; what it is afterwards is of no use.
    virtual void up(const double* change, double* x, double* r) const = 0;

    virtual double entries() const = 0;
};

template <int B>
class BlockGridMatrix final : public GridMatrix {
    using Square = Eigen::Matrix<double, B, B>;

 public:
    void set(const StoredRows& own, const StoredRows& coupling, const std::vector<PetscInt>& place) override {
        const auto same = [](PetscInt column) { return column; };
        n_ = own.rows / B;
        lower_.set(own, n_, same, [](PetscInt i, PetscInt j) { return j < i; });
        coupling_.set(
            coupling, n_, [&](PetscInt column) { return place[column]; }, [](PetscInt, PetscInt) { return true; });
        // One more is read with the last column.
        own_.assign(static_cast<std::size_t>(n_) * B * B + 1, 0.0F);
        inverse_.assign(own_.size(), 0.0F);
        added_.clear();
        if (coupling.rows && coupling.start[coupling.rows]) added_.assign(static_cast<std::size_t>(n_) * B, 0.0);
        for (PetscInt i = 0; i < n_; ++i) set_diagonal(own, coupling, i);
    }

    void down(const double* b, double* x, double* r) const override {
        for (PetscInt i = 0; i < n_; ++i) {
            const ProductSum<B, B> sum = lower_.times(i, x);
            double rest[B];
            for (int d = 0; d < B; ++d) rest[d] = b[i * B + d] - sum[d];
            ProductSum<B, B> found;
            found.add(&inverse_[i * B * B], rest);
            double* own = x + i * B;
            for (int d = 0; d < B; ++d) own[d] = found[d];
            for (int d = 0; d < B; ++d) r[i * B + d] = added_.empty() ? 0.0 : added_[i * B + d] * own[d];
            lower_.take_from(i, own, r);
        }
    }

    void couple(const double* ghosts, double* r) const override {
        for (PetscInt i = 0; i < n_; ++i) {
            const ProductSum<B, B> sum = coupling_.times(i, ghosts);
            for (int d = 0; d < B; ++d) r[i * B + d] -= sum[d];
        }
    }

    void up(const double* change, double* x, double* r) const override {
        for (PetscInt i = n_; i-- > 0;) {
            ProductSum<B, B> sum = lower_.times(i, change), found;
            sum.add(&own_[i * B * B], change + i * B);
            double rest[B], moved[B];
            for (int d = 0; d < B; ++d) rest[d] = r[i * B + d] - sum[d];
            found.add(&inverse_[i * B * B], rest);
            for (int d = 0; d < B; ++d) moved[d] = change[i * B + d] + found[d];
            for (int d = 0; d < B; ++d) x[i * B + d] += moved[d];
            lower_.take_from(i, moved, r);
        }
    }

    double entries() const override {
        return 2.0 * static_cast<double>(lower_.value.size()) + static_cast<double>(own_.size()) +
               static_cast<double>(coupling_.value.size());
    }

 private:
    void set_diagonal(const StoredRows& from, const StoredRows& coupling, PetscInt i) {
        Square own = Square::Zero();
        for (int d = 0; d < B; ++d)
            for (PetscInt k = from.start[i * B + d]; k < from.start[i * B + d + 1]; ++k)
                if (from.column[k] / B == i) own(d, from.column[k] % B) = from.value[k];
        Square relaxed = own;
        if (!added_.empty())
            for (int d = 0; d < B; ++d) {
                double sum = 0.0;
                for (PetscInt k = coupling.start[i * B + d]; k < coupling.start[i * B + d + 1]; ++k)
                    sum += std::abs(coupling.value[k]);
                relaxed(d, d) += added_[i * B + d] = 0.5 * sum;
            }
        const Square inverse = pseudo_inverse(relaxed);
        for (int c = 0; c < B; ++c)
            for (int d = 0; d < B; ++d) {
                own_[(i * B + c) * B + d] = static_cast<float>(own(d, c));
                inverse_[(i * B + c) * B + d] = static_cast<float>(inverse(d, c));
            }
    }

    // Coarse nodes of few fine ones have motions that move nothing: what has no stiffness stays where it is.
    static Square pseudo_inverse(const Square& a) {
        if constexpr (B == 1) {
            Square inverse;
            inverse(0, 0) = a(0, 0) > 0.0 ? 1.0 / a(0, 0) : 0.0;
            return inverse;
        } else {
            if constexpr (B == 2) {
                const double det = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0), all = a(0, 0) * a(1, 1);
                if (a(0, 0) > 0.0 && a(1, 1) > 0.0 && det > 1e-6 * all) {
                    Square inverse;
                    inverse << a(1, 1), -a(0, 1), -a(1, 0), a(0, 0);
                    return inverse / det;
                }
            }
            const Eigen::SelfAdjointEigenSolver<Square> parts(0.5 * (a + a.transpose()));
            const auto& values = parts.eigenvalues();
            const double least = 1e-10 * values.cwiseAbs().maxCoeff();
            Eigen::Matrix<double, B, 1> inverted;
            for (int d = 0; d < B; ++d) inverted[d] = values[d] > least ? 1.0 / values[d] : 0.0;
            return parts.eigenvectors() * inverted.asDiagonal() * parts.eigenvectors().transpose();
        }
    }

    PetscInt n_ = 0;
    SingleBlocks<B, B> lower_, coupling_;
    std::vector<float> own_, inverse_;
    std::vector<double> added_;
};

}  // namespace restshape
