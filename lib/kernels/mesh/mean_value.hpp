// Mean value coordinates: over the whole boundary, and positive ones over the part of it that a point sees.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace restshape {

// Interpolates boundary values into points strictly inside (Hormann and Floater 2006; docs/theory/moving-the-mesh.md).
//
// A segment (a, b) seen under the angle alpha has the share tan(alpha/2) (f(a) + f(b)), f being value over distance.
// With the inside on the left of each segment, what turns its back to the point counts negative. All segments count.
class MeanValue {
 public:
    MeanValue(const double* vertices, const std::int32_t* segments, std::int32_t segment_count)
        : vertices_(vertices), segments_(segments), segment_count_(segment_count) {}

    // Adds up `width` columns of values for one point.
    void interpolate(const double* point, const double* values, std::ptrdiff_t width, double* out) const {
        std::fill(out, out + width, 0.0);
        double total = 0.0;
        for (std::int32_t s = 0; s < segment_count_; ++s) {
            const std::int32_t a = segments_[2 * s], b = segments_[2 * s + 1];
            const double ax = vertices_[2 * a] - point[0], ay = vertices_[2 * a + 1] - point[1];
            const double bx = vertices_[2 * b] - point[0], by = vertices_[2 * b + 1] - point[1];
            const double turn = ax * by - bx * ay, along = ax * bx + ay * by;
            const double ra = std::sqrt(ax * ax + ay * ay), rb = std::sqrt(bx * bx + by * by);
            // Two forms of the tangent of half the angle, each without cancellation on its side of a right angle.
            const double tangent = along > 0.0 ? turn / (ra * rb + along) : (ra * rb - along) / turn;
            const double wa = tangent / ra, wb = tangent / rb;
            const double* at_a = values + width * a;
            const double* at_b = values + width * b;
            for (std::ptrdiff_t c = 0; c < width; ++c) out[c] += wa * at_a[c] + wb * at_b[c];
            total += wa + wb;
        }
        for (std::ptrdiff_t c = 0; c < width; ++c) out[c] /= total;
    }

 private:
    const double* vertices_;
    const std::int32_t* segments_;
    std::int32_t segment_count_;
};

// Interpolates boundary values into points strictly inside (Lipman et al. 2007; docs/theory/moving-the-mesh.md).
//
// The directions around a point are cut at every boundary vertex. Between two cuts one segment (a, b) is nearest. With
// unit directions u, v of the cuts and alpha the angle between them, its share is tan(alpha/2) (f(u) + f(v)), where f
// is value over distance: f(u) = (value_a cross(u, B) + value_b cross(A, u)) / cross(A, B) with A, B the segment's ends
// seen from the point. That is the exact integral of f, so cutting a visible segment changes nothing; and value =
// position gives f(u) = u, so that linear functions are reproduced because the chords around the circle close.
class PositiveMeanValue {
 public:
    PositiveMeanValue(const double* vertices, std::int32_t vertex_count, const std::int32_t* segments,
                      std::int32_t segment_count)
        : vertices_(vertices),
          segments_(segments),
          vertex_count_(vertex_count),
          segment_count_(segment_count),
          first_(vertex_count + 1, 0),
          incident_(2 * segment_count),
          order_(vertex_count),
          seen_(segment_count) {
        for (std::int32_t s = 0; s < 2 * segment_count; ++s) ++first_[segments[s] + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
        for (std::int32_t s = 0; s < 2 * segment_count; ++s) incident_[next[segments[s]]++] = s / 2;
        for (auto* column : {&rx_, &ry_, &ux_, &uy_, &angle_}) column->resize(vertex_count);
    }

    // Adds up `width` columns of values for one point; returns the sum of the weights before they were normalised.
    double interpolate(const double* point, const double* values, std::ptrdiff_t width, double* out) {
        look_around(point);
        std::fill(out, out + width, 0.0);
        double total = 0.0;
        for (std::int32_t k = 0; k < vertex_count_;) {
            const std::int32_t here = order_[k];
            // Cuts closer than rounding count as one, or the nearest segment between them would be noise.
            for (; k < vertex_count_ && angle_[order_[k]] - angle_[here] < same_direction; ++k)
                toggle_incident(order_[k]);
            const std::int32_t there = order_[k < vertex_count_ ? k : 0];
            total += add_share(here, there, values, width, out);
        }
        for (std::ptrdiff_t c = 0; c < width; ++c) out[c] /= total;
        return total;
    }

 private:
    static constexpr double same_direction = 1e-14;

    struct Seen {
        std::int32_t start, end;  // counterclockwise as seen from the point
        double cross;
    };

    void look_around(const double* point) {
        for (std::int32_t v = 0; v < vertex_count_; ++v) {
            rx_[v] = vertices_[2 * v] - point[0];
            ry_[v] = vertices_[2 * v + 1] - point[1];
            const double length = std::sqrt(rx_[v] * rx_[v] + ry_[v] * ry_[v]);
            ux_[v] = rx_[v] / length, uy_[v] = ry_[v] / length;
            // Grows with the angle from 0 to 4: sorts like atan2 at a fraction of its price.
            const double p = ux_[v] / (std::abs(ux_[v]) + std::abs(uy_[v]));
            angle_[v] = uy_[v] >= 0.0 ? 1.0 - p : 3.0 + p;
        }
        std::iota(order_.begin(), order_.end(), 0);
        std::sort(order_.begin(), order_.end(), [this](std::int32_t v, std::int32_t w) {
            return angle_[v] < angle_[w] || (angle_[v] == angle_[w] && v < w);
        });
        active_.clear();
        for (std::int32_t s = 0; s < segment_count_; ++s) {
            const std::int32_t a = segments_[2 * s], b = segments_[2 * s + 1];
            const double turn = ux_[a] * uy_[b] - ux_[b] * uy_[a];
            Seen& seen = seen_[s];
            seen = turn > 0.0 ? Seen{a, b, 0.0} : Seen{b, a, 0.0};
            if (std::abs(turn) < 4.0 * same_direction) continue;  // edge-on: fills no angle
            seen.cross = rx_[seen.start] * ry_[seen.end] - rx_[seen.end] * ry_[seen.start];
            if (angle_[seen.start] > angle_[seen.end]) active_.push_back(s);
        }
    }

    void toggle_incident(std::int32_t vertex) {
        for (std::int32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
            const std::int32_t s = incident_[i];
            if (seen_[s].cross == 0.0) continue;
            const auto place = std::find(active_.begin(), active_.end(), s);
            if (place == active_.end()) {
                active_.push_back(s);
            } else {
                *place = active_.back();
                active_.pop_back();
            }
        }
    }

    double add_share(std::int32_t here, std::int32_t there, const double* values, std::ptrdiff_t width,
                     double* out) const {
        const double ux = ux_[here], uy = uy_[here], vx = ux_[there], vy = uy_[there];
        const double mx = ux + vx, my = uy + vy;
        const Seen* nearest = nullptr;
        double closeness = 0.0;
        for (const std::int32_t s : active_) {
            const Seen& seen = seen_[s];
            const double ex = rx_[seen.end] - rx_[seen.start], ey = ry_[seen.end] - ry_[seen.start];
            const double inverse_distance = (mx * ey - ex * my) / seen.cross;
            if (inverse_distance > closeness) closeness = inverse_distance, nearest = &seen;
        }
        if (!nearest) return 0.0;
        const double tangent = (ux * vy - vx * uy) / (1.0 + ux * vx + uy * vy);
        const double ax = rx_[nearest->start], ay = ry_[nearest->start];
        const double bx = rx_[nearest->end], by = ry_[nearest->end];
        const double share = tangent / nearest->cross;
        const double wa = share * std::max(0.0, mx * by - bx * my);
        const double wb = share * std::max(0.0, ax * my - mx * ay);
        const double* at_a = values + width * nearest->start;
        const double* at_b = values + width * nearest->end;
        for (std::ptrdiff_t c = 0; c < width; ++c) out[c] += wa * at_a[c] + wb * at_b[c];
        return wa + wb;
    }

    const double* vertices_;
    const std::int32_t* segments_;
    std::int32_t vertex_count_, segment_count_;
    std::vector<std::int32_t> first_, incident_, order_, active_;
    std::vector<Seen> seen_;
    std::vector<double> rx_, ry_, ux_, uy_, angle_;
};

}  // namespace restshape
