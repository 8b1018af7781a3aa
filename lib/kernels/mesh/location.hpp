// Finds the triangle that holds a point, by a grid of buckets.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace restshape {

// Interpolates rows of fields (count, n, width) from nodes to points, each from `corners` nodes with as many weights.
//
// Row after row, so that what is gathered from stays in the caches. Fixed: the width, where it is known; else 0.
template <int Fixed>
void interpolate_rows(const std::int32_t* nodes, const double* weights, std::ptrdiff_t points, std::ptrdiff_t corners,
                      const double* rows, std::ptrdiff_t count, std::ptrdiff_t n, std::ptrdiff_t any_width,
                      double* out) {
    const std::ptrdiff_t width = Fixed ? Fixed : any_width;
    for (std::ptrdiff_t r = 0; r < count; ++r, rows += n * width) {
        const std::int32_t* node = nodes;
        const double* weight = weights;
        for (std::ptrdiff_t p = 0; p < points; ++p, out += width) {
            for (std::ptrdiff_t f = 0; f < width; ++f) out[f] = 0.0;
            for (std::ptrdiff_t c = 0; c < corners; ++c, ++node, ++weight) {
                const double* at = rows + width * *node;
                for (std::ptrdiff_t f = 0; f < width; ++f) out[f] += *weight * at[f];
            }
        }
    }
}

class Locator {
 public:
    Locator(const double* X, const std::int32_t* cells, std::ptrdiff_t count)
        : X_(X), cells_(cells), count_(static_cast<std::int32_t>(count)) {
        lower_ = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
        std::array<double, 2> upper = {-lower_[0], -lower_[1]};
        for (std::int32_t i = 0; i < 3 * count_; ++i) {
            for (int k = 0; k < 2; ++k) {
                lower_[k] = std::min(lower_[k], X[2 * cells[i] + k]);
                upper[k] = std::max(upper[k], X[2 * cells[i] + k]);
            }
        }
        const double wide = std::max(upper[0] - lower_[0], 1e-300), high = std::max(upper[1] - lower_[1], 1e-300);
        const double side = std::max(std::sqrt(wide * high / std::max(1, count_)), std::max(wide, high) / 4096.0);
        bins_ = {static_cast<std::int32_t>(wide / side) + 1, static_cast<std::int32_t>(high / side) + 1};
        per_length_ = {bins_[0] / wide, bins_[1] / high};
        fill_buckets();
    }

    // Triangle and barycentric coordinates of a point; a point outside is put on the nearest boundary point. A triangle
    // that is `tried` first holds the point where it may; -1: none.
    std::int32_t locate(const double* point, double* weights, std::int32_t tried = -1) {
        if (tried >= 0 && barycentric(tried, point, weights) >= 0.0) return tried;
        std::int32_t best = -1;
        double closest = -1e-12;
        const std::int32_t bucket = bin(point[0], 0) + bins_[0] * bin(point[1], 1);
        for (std::int32_t i = first_[bucket]; i < first_[bucket + 1]; ++i) {
            double w[3];
            const double smallest = barycentric(members_[i], point, w);
            if (smallest >= closest) {
                closest = smallest, best = members_[i];
                std::copy(w, w + 3, weights);
                if (smallest >= 0.0) return best;
            }
        }
        return best >= 0 ? best : locate_on_boundary(point, weights);
    }

 private:
    std::int32_t bin(double value, int k) const {
        const double place = (value - lower_[k]) * per_length_[k];
        // Negated, so that a coordinate that is not a number falls into some bucket.
        return !(place > 0.0) ? 0 : std::min(bins_[k] - 1, static_cast<std::int32_t>(std::min(place, 1e9)));
    }

    template <class Visit>
    void each_bucket(std::int32_t cell, Visit visit) const {
        const std::int32_t* n = cells_ + 3 * cell;
        const double *a = X_ + 2 * n[0], *b = X_ + 2 * n[1], *c = X_ + 2 * n[2];
        const auto [left, right] = std::minmax({a[0], b[0], c[0]});
        const auto [low, high] = std::minmax({a[1], b[1], c[1]});
        for (std::int32_t j = bin(low, 1); j <= bin(high, 1); ++j) {
            for (std::int32_t i = bin(left, 0); i <= bin(right, 0); ++i) visit(i + bins_[0] * j);
        }
    }

    void fill_buckets() {
        first_.assign(static_cast<std::size_t>(bins_[0]) * bins_[1] + 1, 0);
        for (std::int32_t cell = 0; cell < count_; ++cell)
            each_bucket(cell, [this](std::int32_t b) { ++first_[b + 1]; });
        for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
        members_.resize(first_.back());
        std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
        for (std::int32_t cell = 0; cell < count_; ++cell) {
            each_bucket(cell, [&](std::int32_t b) { members_[next[b]++] = cell; });
        }
    }

    double barycentric(std::int32_t cell, const double* p, double* w) const {
        const std::int32_t* n = cells_ + 3 * cell;
        const double *a = X_ + 2 * n[0], *b = X_ + 2 * n[1], *c = X_ + 2 * n[2];
        const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
        const double px = p[0] - a[0], py = p[1] - a[1];
        const double twice_area = bx * cy - cx * by;
        if (!(twice_area > 0.0)) return -1.0;  // an inverted triangle holds nothing
        w[1] = (px * cy - cx * py) / twice_area;
        w[2] = (bx * py - px * by) / twice_area;
        w[0] = 1.0 - w[1] - w[2];
        return std::min({w[0], w[1], w[2]});
    }

    // Sides of one triangle alone, by their lower, then their higher node: by counts, for sorting all takes longer than
    // looking for all points.
    void find_boundary() {
        const auto ends = [this](std::int32_t side) {
            const std::int32_t cell = side / 3, i = side % 3;
            return std::minmax(cells_[3 * cell + (i + 1) % 3], cells_[3 * cell + (i + 2) % 3]);
        };
        const std::int32_t nodes = 1 + *std::max_element(cells_, cells_ + 3 * static_cast<std::ptrdiff_t>(count_));
        std::vector<std::int32_t> first(nodes + 1, 0), sides(3 * static_cast<std::size_t>(count_));
        for (std::int32_t side = 0; side < 3 * count_; ++side) ++first[ends(side).first + 1];
        for (std::int32_t node = 0; node < nodes; ++node) first[node + 1] += first[node];
        std::vector<std::int32_t> next(first.begin(), first.end() - 1);
        for (std::int32_t side = 0; side < 3 * count_; ++side) sides[next[ends(side).first]++] = side;
        std::vector<std::array<std::int32_t, 2>> own;  // higher node, side
        for (std::int32_t node = 0; node < nodes; ++node) {
            own.clear();
            for (std::int32_t k = first[node]; k < first[node + 1]; ++k)
                own.push_back({ends(sides[k]).second, sides[k]});
            std::sort(own.begin(), own.end());
            for (std::size_t k = 0; k < own.size(); ++k) {
                const bool shared =
                    (k > 0 && own[k - 1][0] == own[k][0]) || (k + 1 < own.size() && own[k + 1][0] == own[k][0]);
                if (!shared) boundary_.push_back({own[k][1] / 3, own[k][1] % 3});
            }
        }
    }

    std::int32_t locate_on_boundary(const double* p, double* weights) {
        if (boundary_.empty()) find_boundary();
        double nearest = std::numeric_limits<double>::max();
        std::int32_t best = -1;
        for (const auto& [cell, corner] : boundary_) {
            const int i = (corner + 1) % 3, j = (corner + 2) % 3;
            const double *a = X_ + 2 * cells_[3 * cell + i], *b = X_ + 2 * cells_[3 * cell + j];
            const double ex = b[0] - a[0], ey = b[1] - a[1], px = p[0] - a[0], py = p[1] - a[1];
            const double length = ex * ex + ey * ey;
            const double t = length > 0.0 ? std::clamp((px * ex + py * ey) / length, 0.0, 1.0) : 0.0;
            const double dx = px - t * ex, dy = py - t * ey, distance = dx * dx + dy * dy;
            if (distance < nearest) {
                nearest = distance, best = cell;
                weights[corner] = 0.0, weights[i] = 1.0 - t, weights[j] = t;
            }
        }
        return best;
    }

    const double* X_;
    const std::int32_t* cells_;
    std::int32_t count_;
    std::array<double, 2> lower_, per_length_;
    std::array<std::int32_t, 2> bins_;
    std::vector<std::int32_t> first_, members_;
    std::vector<std::array<std::int32_t, 2>> boundary_;
};

}  // namespace restshape
