// Where lines and arcs of circles that share a point meet once more, exactly.
#pragma once

#include <cmath>
#include <optional>

#include "shape/outline_point.hpp"

namespace restshape::outline {

// A line, or an arc of a circle: its ends and a place between them.
struct Round {
    Point a, middle, b;

    // Twice the signed area of the triangle of its three places; 0 of a line. An arc that is within a millionth of its
    // length of a line counts as one, for its center is too far away to be known.
    double turn() const { return cross(b - a, middle - a); }
    bool straight() const { return std::abs(turn()) <= 1e-6 * dot(b - a, b - a); }

    Point center() const {
        const Point u = b - a, v = middle - a;
        const double part = 0.5 / cross(u, v), uu = dot(u, u), vv = dot(v, v);
        return {a.x + part * (v.y * uu - u.y * vv), a.y + part * (u.x * vv - v.x * uu)};
    }

    // Whether a place on its line or circle lies between its ends, and not at one of them.
    bool holds(Point p) const {
        const double rounding = 1e-16 * dot(b - a, b - a);
        if (dot(p - a, p - a) <= rounding || dot(p - b, p - b) <= rounding) return false;
        if (straight()) return dot(p - a, b - a) > 0.0 && dot(p - b, a - b) > 0.0;
        return cross(b - a, p - a) * turn() > 0.0;
    }
};

// The place that mirrors p in the line through `on` along d: where two circles meet again if their centers are on it.
inline Point mirrored(Point p, Point on, Point d) {
    const double part = 2.0 * cross(d, p - on) / dot(d, d);
    return {p.x + part * d.y, p.y - part * d.x};
}

// Where two of them that meet at `shared` meet a second time, inside both.
inline std::optional<Point> second_meeting(const Round& one, const Round& other, Point shared) {
    if (one.straight() && other.straight()) return std::nullopt;
    Point on, along;
    if (one.straight() || other.straight()) {
        // A line meets a circle again beyond the foot of its center.
        const Round& line = one.straight() ? one : other;
        on = (one.straight() ? other : one).center();
        along = {line.a.y - line.b.y, line.b.x - line.a.x};
    } else {
        on = one.center();
        along = other.center() - on;
        if (!(dot(along, along) > 0.0)) return std::nullopt;
    }
    const Point found = mirrored(shared, on, along);
    return one.holds(found) && other.holds(found) ? std::optional<Point>(found) : std::nullopt;
}

}  // namespace restshape::outline
