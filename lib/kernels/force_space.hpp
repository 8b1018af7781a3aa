// Combinations of design modes that lead into a box in the space of forces: (6.18) to (6.21) of the thesis.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <unordered_set>
#include <vector>

namespace restshape {

constexpr int most_combined = 5;

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
// low <= h + t K y / |y| <= high for some 0 <= t <= longest. Those are left out that hold a smaller one that does.
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
        pairs_.assign(size_t(m) * m, 0);
    }

    // barred: modes that already work alone. keep: rays for each leading mode and count, the widest; 0 keeps all.
    void search(int most, int least, const std::vector<char>& barred, int keep) {
        if (least < 1 || most < least || most > most_combined)
            throw std::invalid_argument("force space: combine 1 to 5 modes");
        barred_ = barred;
        keep_ = keep;
        buckets_.assign(keep > 0 ? size_t(m_) * most : 0, {});
        rays_.clear();
        tried_.assign(most, 0);
        for (int count = least; count <= most; ++count) {
            count_ = count;
            descend(0, 0);
            // What works counts from the next size on.
            for (const auto& found : found_) note(found);
            found_.clear();
        }
        for (const auto& bucket : buckets_) rays_.insert(rays_.end(), bucket.begin(), bucket.end());
    }

    const std::vector<Ray>& rays() const { return rays_; }
    const std::vector<int64_t>& tried() const { return tried_; }

 private:
    struct Found {
        int modes[most_combined];
        int count;
    };
    int m_, rows_;
    RayLimits limits_;
    std::vector<double> K_, gram_, slope_, h_, low_, high_;
    std::vector<char> barred_, pairs_;
    std::unordered_set<uint64_t> larger_;
    std::vector<Found> found_;
    std::vector<Ray> rays_;
    std::vector<std::vector<Ray>> buckets_;
    std::vector<int64_t> tried_;
    int count_ = 0, keep_ = 0;
    int modes_[most_combined];
    // Cholesky's factor of the Gram matrix of the modes so far, and its forward solution.
    double factor_[most_combined][most_combined], pivot_[most_combined], forward_[most_combined];

    static uint64_t key(const int* modes, int count, int without) {
        uint64_t sum = 0;
        for (int k = 0; k < count; ++k)
            if (k != without) sum = sum * 4096 + modes[k] + 1;
        return sum;
    }

    void note(const Found& found) {
        if (found.count == 1) barred_[found.modes[0]] = 1;
        if (found.count == 2) pairs_[size_t(found.modes[0]) * m_ + found.modes[1]] = 1;
        if (found.count > 2) larger_.insert(key(found.modes, found.count, -1));
    }

    void descend(int level, int first) {
        if (level >= most_combined) return;
        const bool last = level + 1 == count_;
        for (int i = first; i < m_ - (count_ - level - 1); ++i) {
            if (count_ > 1 && barred_[i]) continue;
            if (paired(level, i)) continue;
            modes_[level] = i;
            tried_[count_ - 1] += last;
            if (!extend(level, i)) continue;
            if (last) {
                if (count_ < 4 || !contains_larger()) ray();
            } else {
                descend(level + 1, i + 1);
            }
        }
    }

    bool paired(int level, int i) const {
        if (count_ < 3) return false;
        for (int k = 0; k < level; ++k)
            if (pairs_[size_t(modes_[k]) * m_ + i]) return true;
        return false;
    }

    // Whether a smaller combination of three or more, inside the present one, works.
    bool contains_larger() const {
        for (int without = 0; without < count_; ++without)
            if (larger_.count(key(modes_, count_, without))) return true;
        if (count_ < 5) return false;
        for (int a = 0; a < count_; ++a)
            for (int b = a + 1; b < count_; ++b) {
                int rest[most_combined], left = 0;
                for (int k = 0; k < count_; ++k)
                    if (k != a && k != b) rest[left++] = modes_[k];
                if (larger_.count(key(rest, left, -1))) return true;
            }
        return false;
    }

    // A further row of Cholesky's factor; false for a mode that depends on those before.
    bool extend(int level, int i) {
        const double* gram = &gram_[size_t(i) * m_];
        double rest = gram[i], forward = slope_[i];
        for (int k = 0; k < level; ++k) {
            double sum = gram[modes_[k]];
            for (int l = 0; l < k; ++l) sum -= factor_[level][l] * factor_[k][l];
            sum *= pivot_[k];
            factor_[level][k] = sum;
            rest -= sum * sum;
            forward -= sum * forward_[k];
        }
        if (!(rest > 1e-10 * gram[i])) return false;
        pivot_[level] = 1.0 / std::sqrt(rest);
        forward_[level] = forward * pivot_[level];
        return true;
    }

    void ray() {
        double y[most_combined], size2 = 0.0;
        for (int k = count_ - 1; k >= 0; --k) {
            double sum = forward_[k];
            for (int l = k + 1; l < count_; ++l) sum -= factor_[l][k] * y[l];
            y[k] = sum * pivot_[k];
            size2 += y[k] * y[k];
        }
        if (!(size2 > 0.0)) return;
        // |K y|^2 is the square of the forward solution.
        double gain2 = 0.0;
        for (int k = 0; k < count_; ++k) gain2 += forward_[k] * forward_[k];
        if (gain2 < limits_.least_gain * limits_.least_gain * size2) return;
        const double scale = 1.0 / std::sqrt(size2);
        const double* along[most_combined];
        for (int k = 0; k < count_; ++k) y[k] *= scale, along[k] = &K_[size_t(modes_[k]) * rows_];
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
        Found found{{}, count_};
        int leading = 0;
        for (int k = 0; k < count_; ++k) {
            ray.modes[k] = found.modes[k] = modes_[k], ray.direction[k] = y[k];
            if (std::abs(y[k]) > std::abs(y[leading])) leading = k;
        }
        found_.push_back(found);
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
