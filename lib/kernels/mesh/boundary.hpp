// Sizes along an outline: narrow places, grading, and the parameters of nodes at steps of the size.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace restshape {

// Samples of all edges, one edge after the other: edge e has those from first[e] to first[e + 1].
struct BoundarySamples {
    const double* points;          // (m, 2)
    const double* arc;             // (m,) length from the start of the edge
    const std::int32_t* first;     // (edges + 1,)
    const std::int32_t* ends;      // (edges, 2) vertices
    const std::uint8_t* straight;  // (edges,)
    const double* side;            // (edges,) 1 or -1 if the material is only left or right, 0 if on both sides
    std::int32_t edges;
};

class NarrowPlaces {
 public:
    // `fold`: two samples face each other only if the way along their edges is so many times longer.
    NarrowPlaces(const BoundarySamples& samples, double reach, double fold)
        : in_(samples), reach_(reach), fold_(fold), owner_(count()), tangent_(2 * count()), spacing_(count()) {
        for (std::int32_t e = 0; e < in_.edges; ++e)
            for (std::int32_t i = in_.first[e]; i < in_.first[e + 1]; ++i) {
                owner_[i] = e;
                const std::int32_t a = std::max(i - 1, in_.first[e]), b = std::min(i + 1, in_.first[e + 1] - 1);
                const double x = (in_.points[2 * b] - in_.points[2 * a]) / (b - a);
                const double y = (in_.points[2 * b + 1] - in_.points[2 * a + 1]) / (b - a);
                spacing_[i] = std::hypot(x, y);
                const double scale = 1.0 / std::max(spacing_[i], 1e-300);
                tangent_[2 * i] = x * scale, tangent_[2 * i + 1] = y * scale;
            }
    }

    // Width of the material at each sample, infinite where wider than the reach.
    std::vector<double> widths() {
        std::vector<double> width(count(), std::numeric_limits<double>::infinity());
        // A sweep along x: only samples within the reach meet.
        std::vector<std::int32_t> order(count());
        std::iota(order.begin(), order.end(), 0);
        std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
            return in_.points[2 * a] != in_.points[2 * b] ? in_.points[2 * a] < in_.points[2 * b] : a < b;
        });
        for (std::size_t k = 0; k < order.size(); ++k)
            for (std::size_t l = k + 1; l < order.size(); ++l) {
                const std::int32_t i = order[k], j = order[l];
                const double x = in_.points[2 * j] - in_.points[2 * i];
                if (x > reach_) break;
                const double y = in_.points[2 * j + 1] - in_.points[2 * i + 1];
                if (std::abs(y) <= reach_ && x * x + y * y <= reach_ * reach_ && face(i, j, x, y)) {
                    width[i] = std::min(width[i], across(j, x, y));
                    width[j] = std::min(width[j], across(i, x, y));
                }
            }
        return width;
    }

 private:
    std::size_t count() const { return static_cast<std::size_t>(in_.first[in_.edges]); }

    bool faces(std::int32_t i, double x, double y) const {
        const double side = in_.side[owner_[i]];
        return side == 0.0 || side * (tangent_[2 * i] * y - tangent_[2 * i + 1] * x) > 0.0;
    }

    bool face(std::int32_t i, std::int32_t j, double x, double y) const {
        // Neighbours on one straight edge never face each other.
        if (owner_[i] == owner_[j] && in_.straight[owner_[i]]) return false;
        return faces(i, x, y) && faces(j, -x, -y) && way(i, j) > fold_ * std::hypot(x, y);
    }

    // Length of the way along the edges; infinite if these share no vertex.
    double way(std::int32_t i, std::int32_t j) const {
        const std::int32_t e = owner_[i], f = owner_[j];
        if (e == f) return std::abs(in_.arc[i] - in_.arc[j]);
        double least = std::numeric_limits<double>::infinity();
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                if (in_.ends[2 * e + a] == in_.ends[2 * f + b]) least = std::min(least, to_end(i, a) + to_end(j, b));
        return least;
    }

    double to_end(std::int32_t i, int end) const {
        return end ? in_.arc[in_.first[owner_[i] + 1] - 1] - in_.arc[i] : in_.arc[i];
    }

    // Distance to the piece of the boundary that sample j stands for.
    double across(std::int32_t j, double x, double y) const {
        const double along = std::abs(x * tangent_[2 * j] + y * tangent_[2 * j + 1]);
        const double away = x * tangent_[2 * j + 1] - y * tangent_[2 * j];
        return std::hypot(away, std::max(along - 0.5 * spacing_[j], 0.0));
    }

    BoundarySamples in_;
    double reach_, fold_;
    std::vector<std::int32_t> owner_;
    std::vector<double> tangent_, spacing_;
};

// Shortens sizes around all places where they are below `coarsest`, from the shortest on.
inline void grade_sizes(const double* points, double* size, std::int32_t count, double growth, double coarsest) {
    std::vector<std::int32_t> order;
    for (std::int32_t i = 0; i < count; ++i)
        if (size[i] < (1.0 - 1e-9) * coarsest) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return size[a] < size[b]; });
    for (const std::int32_t i : order) {
        const double own = size[i], x = points[2 * i], y = points[2 * i + 1];
        for (std::int32_t j = 0; j < count; ++j) {
            const double dx = points[2 * j] - x, dy = points[2 * j + 1] - y;
            size[j] = std::min(size[j], own + growth * std::sqrt(dx * dx + dy * dy));
        }
    }
}

// Where a piecewise linear function given at ascending places takes a value, or its value at a place.
inline double interpolate(const double* places, const double* values, std::int32_t count, double at) {
    if (at <= places[0]) return values[0];
    if (at >= places[count - 1]) return values[count - 1];
    const std::int32_t i = static_cast<std::int32_t>(std::upper_bound(places, places + count, at) - places) - 1;
    return values[i] + (at - places[i]) / (places[i + 1] - places[i]) * (values[i + 1] - values[i]);
}

// Parameters of the nodes inside an edge: those stops that lie inside it, and between two stops equal steps of length
// over size, at least `fewest`.
inline std::vector<double> edge_parameters(const double* s, const double* arc, const double* size, std::int32_t count,
                                           const double* stops, std::int32_t stop_count, int fewest) {
    std::vector<double> total(count, 0.0), found;
    for (std::int32_t i = 1; i < count; ++i)
        total[i] = total[i - 1] + (arc[i] - arc[i - 1]) * 0.5 * (1.0 / size[i] + 1.0 / size[i - 1]);
    for (std::int32_t k = 0; k + 1 < stop_count; ++k) {
        const double low = interpolate(s, total.data(), count, stops[k]);
        const double high = interpolate(s, total.data(), count, stops[k + 1]);
        const int steps = std::max(static_cast<int>(std::lrint(high - low)), fewest);
        for (int i = 1; i < steps; ++i)
            found.push_back(interpolate(total.data(), s, count, low + (high - low) * i / steps));
        if (k + 2 < stop_count) found.push_back(stops[k + 1]);
    }
    return found;
}

}  // namespace restshape
