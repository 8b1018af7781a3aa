#include "block_factor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace restshape {

namespace {

// Four lanes of a column of a block, whatever its alignment.
typedef float Lanes __attribute__((vector_size(16), aligned(4)));

Lanes& lanes_at(float* at) { return *reinterpret_cast<Lanes*>(at); }
const Lanes& lanes_at(const float* at) { return *reinterpret_cast<const Lanes*>(at); }

// Smallest pivot over the matrix's own that counts as positive.
constexpr double least_pivot = 1e-3;

// The inverse of a symmetric block by Cholesky; false where a pivot is not well above zero compared with `own`.
bool invert(const float* S, const float* own, float* inverse) {
    const double a = S[0], b = S[1], c = S[2], d = S[5], e = S[6], g = S[10];
    if (!(a > least_pivot * own[0])) return false;
    const double l1 = b / a, l2 = c / a, p1 = d - l1 * b;
    if (!(p1 > least_pivot * own[5])) return false;
    const double q = e - l2 * b, l3 = q / p1, p2 = g - l2 * c - l3 * q;
    if (!(p2 > least_pivot * own[10])) return false;
    const double i2 = 1 / p2, i1 = 1 / p1, m = l1 * l3 - l2;
    const double z[6] = {
        1 / a + l1 * l1 * i1 + m * m * i2, -l1 * i1 - l3 * m * i2, m * i2, i1 + l3 * l3 * i2, -l3 * i2, i2};
    const double full[12] = {z[0], z[1], z[2], 0, z[1], z[3], z[4], 0, z[2], z[4], z[5], 0};
    for (int k = 0; k < 12; ++k) inverse[k] = static_cast<float>(full[k]);
    return true;
}

}  // namespace

bool BlockFactor::compute(Mat mat) {
    PetscObjectId id = 0;
    PetscObjectState pattern = 0;
    PetscInt rows = 0;
    PetscBool done = PETSC_FALSE;
    const PetscInt *row = nullptr, *column = nullptr;
    const PetscScalar* value = nullptr;
    if (PetscObjectGetId(reinterpret_cast<PetscObject>(mat), &id) || MatGetNonzeroState(mat, &pattern)) return false;
    if (MatGetRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &rows, &row, &column, &done) || !done) return false;
    bool good = true;
    if (id != of_ || pattern != pattern_) {
        good = read_pattern(row, column, static_cast<int>(rows));
        if (good) collect_updates();
        of_ = good ? id : 0;
        pattern_ = pattern;
    }
    if (good && !MatSeqAIJGetArrayRead(mat, &value)) {
        factorize(row, value);
        (void)MatSeqAIJRestoreArrayRead(mat, &value);
    }
    (void)MatRestoreRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &rows, &row, &column, &done);
    return good && value == nullptr;
}

bool BlockFactor::read_pattern(const PetscInt* row, const PetscInt* column, int rows) {
    if (rows % f) return false;
    nodes_ = rows / f;
    start_.assign(1, 0);
    column_.clear();
    place_.clear();
    diagonal_.assign(nodes_, -1);
    for (int i = 0; i < nodes_; ++i) {
        const PetscInt *r = row + f * i, length = r[1] - r[0];
        if (length % f) return false;
        for (int a = 1; a < f; ++a)
            if (r[a + 1] - r[a] != length || std::memcmp(column + r[0], column + r[a], length * sizeof(PetscInt)))
                return false;
        for (int k = 0; k < length; k += f) {
            const PetscInt first = column[r[0] + k];
            if (first % f || column[r[0] + k + f - 1] != first + f - 1) return false;
            const int j = static_cast<int>(first / f);
            if (j == i) diagonal_[i] = k;
            if (j >= i) continue;
            column_.push_back(j);
            place_.push_back(k);
        }
        if (diagonal_[i] < 0) return false;
        start_.push_back(static_cast<int32_t>(column_.size()));
    }
    lower_.resize(column_.size() * block);
    inverse_.resize(static_cast<size_t>(nodes_) * block);
    work_.resize(static_cast<size_t>(nodes_) * lanes);
    return true;
}

void BlockFactor::collect_updates() {
    std::vector<int32_t> slot(nodes_, -1);
    first_update_.assign(1, 0);
    updates_.clear();
    size_t longest = 0;
    for (int i = 0; i < nodes_; ++i) {
        for (int q = start_[i]; q < start_[i + 1]; ++q) slot[column_[q]] = q - start_[i];
        for (int q = start_[i]; q < start_[i + 1]; ++q) {
            const int j = column_[q];
            for (int s = start_[j]; s < start_[j + 1]; ++s)
                if (slot[column_[s]] >= 0) updates_.push_back({slot[column_[s]], s});
            first_update_.push_back(static_cast<int32_t>(updates_.size()));
        }
        for (int q = start_[i]; q < start_[i + 1]; ++q) slot[column_[q]] = -1;
        longest = std::max<size_t>(longest, start_[i + 1] - start_[i]);
    }
    scaled_.resize(longest * block);
}

void BlockFactor::factorize(const PetscInt* row, const double* value) {
    kept_pivots_ = 0;
    const auto load = [&](int i, int k, float* to) {
        const double* from = value + row[f * i] + k;
        const PetscInt length = row[f * i + 1] - row[f * i];
        for (int c = 0; c < f; ++c) {
            for (int a = 0; a < f; ++a) to[c * lanes + a] = static_cast<float>(from[a * length + c]);
            to[c * lanes + f] = 0.0f;
        }
    };
    // to -= A B^T, or A B for a symmetric B.
    const auto subtract = [](const float* A, const float* B, float* to) {
        const Lanes a0 = lanes_at(A), a1 = lanes_at(A + lanes), a2 = lanes_at(A + 2 * lanes);
        for (int c = 0; c < f; ++c) lanes_at(to + c * lanes) -= a0 * B[c] + a1 * B[lanes + c] + a2 * B[2 * lanes + c];
    };
    for (int i = 0; i < nodes_; ++i) {
        float own[block], D[block];
        load(i, diagonal_[i], own);
        for (int a = 0; a < f; ++a) own[a * lanes + a] *= static_cast<float>(1.0 + shift_);
        std::memcpy(D, own, sizeof D);
        for (int q = start_[i]; q < start_[i + 1]; ++q) {
            float* S = scaled_.data() + static_cast<size_t>(q - start_[i]) * block;
            load(i, place_[q], S);
            for (int u = first_update_[q]; u < first_update_[q + 1]; ++u)
                subtract(scaled_.data() + static_cast<size_t>(updates_[u].left) * block,
                         lower_.data() + static_cast<size_t>(updates_[u].right) * block, S);
            float* L = lower_.data() + static_cast<size_t>(q) * block;
            const float* Dj = inverse_.data() + static_cast<size_t>(column_[q]) * block;
            for (int c = 0; c < f; ++c)
                lanes_at(L + c * lanes) = lanes_at(S) * Dj[c] + lanes_at(S + lanes) * Dj[lanes + c] +
                                          lanes_at(S + 2 * lanes) * Dj[2 * lanes + c];
            subtract(S, L, D);
        }
        float* inverse = inverse_.data() + static_cast<size_t>(i) * block;
        if (invert(D, own, inverse)) continue;
        ++kept_pivots_;
        if (!invert(own, own, inverse))
            for (int k = 0; k < block; ++k) inverse[k] = k % (lanes + 1) ? 0.0f : 1.0f / std::fabs(own[k]);
    }
}

void BlockFactor::solve(const double* r, double* z) {
    float* w = work_.data();
    for (int i = 0; i < nodes_; ++i) {
        Lanes s0 = {static_cast<float>(r[f * i]), static_cast<float>(r[f * i + 1]), static_cast<float>(r[f * i + 2]),
                    0};
        Lanes s1 = {0, 0, 0, 0}, s2 = {0, 0, 0, 0};
        const float* L = lower_.data() + static_cast<size_t>(start_[i]) * block;
        for (int q = start_[i]; q < start_[i + 1]; ++q, L += block) {
            const float* x = w + static_cast<size_t>(column_[q]) * lanes;
            s0 -= lanes_at(L) * x[0];
            s1 -= lanes_at(L + lanes) * x[1];
            s2 -= lanes_at(L + 2 * lanes) * x[2];
        }
        lanes_at(w + static_cast<size_t>(i) * lanes) = s0 + s1 + s2;
    }
    for (int i = 0; i < nodes_; ++i) {
        const float* D = inverse_.data() + static_cast<size_t>(i) * block;
        Lanes& x = lanes_at(w + static_cast<size_t>(i) * lanes);
        const Lanes y = x;
        x = lanes_at(D) * y[0] + lanes_at(D + lanes) * y[1] + lanes_at(D + 2 * lanes) * y[2];
    }
    for (int i = nodes_ - 1; i >= 0; --i) {
        const float *y = w + static_cast<size_t>(i) * lanes, y0 = y[0], y1 = y[1], y2 = y[2];
        for (int a = 0; a < f; ++a) z[f * i + a] = y[a];
        const float* L = lower_.data() + static_cast<size_t>(start_[i]) * block;
        for (int q = start_[i]; q < start_[i + 1]; ++q, L += block) {
            float* x = w + static_cast<size_t>(column_[q]) * lanes;
            for (int c = 0; c < f; ++c) x[c] -= L[lanes * c] * y0 + L[lanes * c + 1] * y1 + L[lanes * c + 2] * y2;
        }
    }
}

}  // namespace restshape
