// Combinations of design modes that lead into a box in the space of forces: (6.18) to (6.21) of the thesis.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <unordered_set>
#include <vector>

namespace restshape {

constexpr int most_combined = 5;
constexpr double nothing = 1e-14, dependent = 1e-10;  // of the largest square of a mode's change of forces
constexpr double least_part = 1e-6;                   // of a unit direction: a mode with less takes no part

// A combination: its modes in rising order, the unit direction in them, and where along it the box is entered and left.
struct Ray {
    int count;
    int modes[most_combined];
    double direction[most_combined], enters, leaves;
};

struct RayLimits {
    double least_gain;  // of the norm of the change of force along a unit direction
    double longest;     // of a step
};

// All combinations of at most M modes whose least squares direction y = argmin |K y + e| reaches the box
// low <= h + t K y / |y| <= high for some 0 <= t <= longest, but for those that hold a barred combination, or a mode
// that takes no part in y.
class ForceSpace {
 public:
    // K: the change of each force along each mode, one mode after another (m, rows).
    ForceSpace(const double* K, const double* h, const double* e, const double* low, const double* high, int m,
               int rows, RayLimits limits)
        : m_(m), rows_(rows), limits_(limits), K_(m * rows), gram_(m * m), slope_(m) {
        if (m >= 4096) throw std::invalid_argument("force space: at most 4095 modes");
        // Forces that are out of the box come first: they end most rays.
        std::vector<int> order(rows);
        for (int r = 0; r < rows; ++r) order[r] = r;
        const auto out = [&](int r) { return std::max(low[r] - h[r], h[r] - high[r]); };
        std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return out(a) > out(b); });
        for (int r : order) h_.push_back(h[r]), low_.push_back(low[r] - h[r]), high_.push_back(high[r] - h[r]);
        for (int i = 0; i < m; ++i)
            for (int r = 0; r < rows; ++r) K_[i * rows + r] = K[i * rows + order[r]];
        for (int i = 0; i < m; ++i) {
            for (int r = 0; r < rows; ++r) slope_[i] -= K_[i * rows + r] * e[order[r]];
            for (int j = 0; j <= i; ++j) {
                double sum = 0.0;
                for (int r = 0; r < rows; ++r) sum += K_[i * rows + r] * K_[j * rows + r];
                gram_[i * m + j] = gram_[j * m + i] = sum;
            }
        }
        for (int i = 0; i < m; ++i) most_ = std::max(most_, gram_[i * m + i]);
        barred_.assign(m, 0);
        pairs_.assign(size_t(m) * m, 0);
    }

    // Leave out from now on what holds these modes, in rising order.
    void bar(const std::vector<int>& modes) {
        const int count = static_cast<int>(modes.size());
        if (count < 1 || count > most_combined) throw std::invalid_argument("force space: bar 1 to 5 modes");
        for (int k = 0; k < count; ++k)
            if (modes[k] < (k ? modes[k - 1] + 1 : 0) || modes[k] >= m_)
                throw std::invalid_argument("force space: barred modes must be in rising order");
        if (count == 1) barred_[modes[0]] = 1;
        if (count == 2) pairs_[size_t(modes[0]) * m_ + modes[1]] = 1;
        if (count > 2) larger_.insert(key(modes.data(), count));
    }

    // keep: rays for each leading mode and count, the widest; 0 keeps all.
    void search(int most, int least, int keep) {
        if (least < 1 || most < least || most > most_combined)
            throw std::invalid_argument("force space: combine 1 to 5 modes");
        keep_ = keep;
        buckets_.assign(keep > 0 ? size_t(m_) * most : 0, {});
        rays_.clear();
        tried_.assign(most, 0);
        for (count_ = least; count_ <= most; ++count_) descend(0, 0);
        for (const auto& bucket : buckets_) rays_.insert(rays_.end(), bucket.begin(), bucket.end());
    }

    const std::vector<Ray>& rays() const { return rays_; }
    const std::vector<int64_t>& tried() const { return tried_; }

 private:
    int m_, rows_;
    RayLimits limits_;
    double most_ = 0.0;
    std::vector<double> K_, gram_, slope_, h_, low_, high_;
    std::vector<char> barred_, pairs_;
    std::unordered_set<uint64_t> larger_;
    std::vector<Ray> rays_;
    std::vector<std::vector<Ray>> buckets_;
    std::vector<int64_t> tried_;
    int count_ = 0, keep_ = 0;
    int modes_[most_combined];
    // Cholesky's factor of the Gram matrix of the modes so far, and its forward solution.
    double factor_[most_combined][most_combined], pivot_[most_combined], forward_[most_combined];

    static uint64_t key(const int* modes, int count) {
        uint64_t sum = 0;
        for (int k = 0; k < count; ++k) sum = sum * 4096 + modes[k] + 1;
        return sum;
    }

    void descend(int level, int first) {
        if (level >= most_combined) return;
        const bool last = level + 1 == count_;
        for (int i = first; i < m_ - (count_ - level - 1); ++i) {
            if (barred_[i] || paired(level, i)) continue;
            modes_[level] = i;
            tried_[count_ - 1] += last;
            if (!extend(level, i)) continue;
            if (last) {
                if (larger_.empty() || !holds_larger()) ray();
            } else {
                descend(level + 1, i + 1);
            }
        }
    }

    bool paired(int level, int i) const {
        for (int k = 0; k < level; ++k)
            if (pairs_[size_t(modes_[k]) * m_ + i]) return true;
        return false;
    }

    // Whether three or more of the present modes are a barred combination.
    bool holds_larger() const {
        for (unsigned some = 0; some < 1u << count_; ++some) {
            int part[most_combined], left = 0;
            for (int k = 0; k < count_; ++k)
                if (some >> k & 1u) part[left++] = modes_[k];
            if (left > 2 && larger_.count(key(part, left))) return true;
        }
        return false;
    }

    // A further row of Cholesky's factor; false for a mode that changes nothing. One that changes nothing of its own
    // has no pivot.
    bool extend(int level, int i) {
        const double* gram = &gram_[size_t(i) * m_];
        if (!(gram[i] > nothing * most_)) return false;
        double rest = gram[i], forward = slope_[i], largest = gram[i];
        for (int k = 0; k < level; ++k) {
            largest = std::max(largest, gram_[size_t(modes_[k]) * m_ + modes_[k]]);
            double sum = gram[modes_[k]];
            for (int l = 0; l < k; ++l) sum -= factor_[level][l] * factor_[k][l];
            sum *= pivot_[k];
            factor_[level][k] = sum;
            rest -= sum * sum;
            forward -= sum * forward_[k];
        }
        const bool own = rest > dependent * largest;
        pivot_[level] = own ? 1.0 / std::sqrt(rest) : 0.0;
        forward_[level] = own ? forward * pivot_[level] : 0.0;
        return true;
    }

    // Solves with the transposed factor in place; modes without a pivot get 0.
    void backward(double* y) const {
        for (int k = count_ - 1; k >= 0; --k) {
            for (int l = k + 1; l < count_; ++l) y[k] -= factor_[l][k] * y[l];
            y[k] *= pivot_[k];
        }
    }

    // The least squares change of the modes; of those that do the same, the shortest.
    void least(double* y) const {
        std::copy_n(forward_, count_, y);
        backward(y);
        // Modes d without a pivot do what C y_d of the others does: (I + C^T C) y_d = C^T y, and y less C y_d.
        double C[most_combined][most_combined], A[most_combined][most_combined], b[most_combined];
        int which[most_combined], n = 0;
        for (int d = 0; d < count_; ++d) {
            if (pivot_[d] > 0.0) continue;
            for (int k = 0; k < count_; ++k) C[n][k] = k < d ? factor_[d][k] : 0.0;
            backward(C[n]);
            which[n++] = d;
        }
        for (int i = 0; i < n; ++i) {
            b[i] = std::inner_product(y, y + count_, C[i], 0.0);
            for (int j = 0; j < n; ++j) A[i][j] = std::inner_product(C[i], C[i] + count_, C[j], i == j ? 1.0 : 0.0);
        }
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j) {
                const double part = A[j][i] / A[i][i];
                for (int k = i; k < n; ++k) A[j][k] -= part * A[i][k];
                b[j] -= part * b[i];
            }
        for (int i = n - 1; i >= 0; --i) {
            for (int j = i + 1; j < n; ++j) b[i] -= A[i][j] * b[j];
            b[i] /= A[i][i];
        }
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < count_; ++k) y[k] -= C[i][k] * b[i];
        }
        for (int i = 0; i < n; ++i) y[which[i]] = b[i];
    }

    void ray() {
        double y[most_combined], size2 = 0.0;
        least(y);
        for (int k = 0; k < count_; ++k) size2 += y[k] * y[k];
        if (!(size2 > 0.0)) return;
        // |K y|^2 is the square of the forward solution.
        double gain2 = 0.0;
        for (int k = 0; k < count_; ++k) gain2 += forward_[k] * forward_[k];
        if (gain2 < limits_.least_gain * limits_.least_gain * size2) return;
        const double scale = 1.0 / std::sqrt(size2);
        const double* along[most_combined];
        for (int k = 0; k < count_; ++k) {
            y[k] *= scale, along[k] = &K_[size_t(modes_[k]) * rows_];
            // The ray of the others, which is looked at without this mode.
            if (std::abs(y[k]) < least_part) return;
        }
        double enters = 0.0, leaves = limits_.longest;
        for (int r = 0; r < rows_; ++r) {
            double a = 0.0;
            for (int k = 0; k < count_; ++k) a += y[k] * along[k][r];
            if (a > 0.0) {
                if (low_[r] > enters * a) enters = low_[r] / a;
                if (high_[r] < leaves * a) leaves = high_[r] / a;
            } else if (a < 0.0) {
                if (high_[r] < enters * a) enters = high_[r] / a;
                if (low_[r] > leaves * a) leaves = low_[r] / a;
            } else if (low_[r] > 0.0 || high_[r] < 0.0) {
                return;
            }
            if (!(enters <= leaves)) return;
        }
        take(y, enters, leaves);
    }

    void take(const double* y, double enters, double leaves) {
        Ray ray{count_, {}, {}, enters, leaves};
        int leading = 0;
        for (int k = 0; k < count_; ++k) {
            ray.modes[k] = modes_[k], ray.direction[k] = y[k];
            if (std::abs(y[k]) > std::abs(y[leading])) leading = k;
        }
        if (keep_ == 0) return rays_.push_back(ray);
        auto& bucket = buckets_[size_t(count_ - 1) * m_ + modes_[leading]];
        const auto wider = [](const Ray& a, const Ray& b) { return a.leaves - a.enters > b.leaves - b.enters; };
        const auto at = std::upper_bound(bucket.begin(), bucket.end(), ray, wider);
        if (at - bucket.begin() >= keep_) return;
        bucket.insert(at, ray);
        if (static_cast<int>(bucket.size()) > keep_) bucket.pop_back();
    }
};

}  // namespace restshape
