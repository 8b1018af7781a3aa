// Distances between parts of a sheet, edges and edges or triangles and nodes, with the way from one to the other.
//
// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.
#pragma once

#include <algorithm>
#include <cmath>

namespace restshape {

struct Point3 {
    double x, y, z;
    Point3 operator+(const Point3& o) const { return {x + o.x, y + o.y, z + o.z}; }
    Point3 operator-(const Point3& o) const { return {x - o.x, y - o.y, z - o.z}; }
    Point3 operator*(double s) const { return {x * s, y * s, z * s}; }
    double dot(const Point3& o) const { return x * o.x + y * o.y + z * o.z; }
    Point3 cross(const Point3& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
    double norm() const { return std::sqrt(dot(*this)); }
};

inline double share(double value) { return std::min(std::max(value, 0.0), 1.0); }

// From the nearest place of the segment from c to d to that of the one from a to b.
inline Point3 segment_way(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
    const Point3 u = b - a, v = d - c, w = a - c;
    const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
    const double square = uu * vv - uv * uv;
    double s = square > 0 ? share((uv * vw - vv * uw) / square) : 0.0;
    double t = vv > 0 ? (uv * s + vw) / vv : 0.0;
    if (t < 0 || t > 1) {
        t = share(t);
        s = uu > 0 ? share((uv * t - uw) / uu) : 0.0;
    }
    return w + u * s - v * t;
}

// From the nearest place of the triangle a b c to a point.
inline Point3 triangle_way(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
    const Point3 u = b - a, v = c - a, w = p - a;
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
    const double square = uu * vv - uv * uv;
    if (square > 0) {
        const double s = (vv * uw - uv * vw) / square, t = (uu * vw - uv * uw) / square;
        if (s >= 0 && t >= 0 && s + t <= 1) return w - u * s - v * t;
    }
    Point3 way = segment_way(p, p, a, b);
    for (const Point3& other : {segment_way(p, p, b, c), segment_way(p, p, c, a)})
        if (other.dot(other) < way.dot(way)) way = other;
    return way;
}

// Whether the segment from p to q passes through the triangle a b c, by more than a 1e9th of either. One that lies in
// the triangle's plane, but for rounding, does not.
// Source: Möller and Trumbore, Journal of Graphics Tools 2(1), 1997, 21.
inline bool passes_through(const Point3& p, const Point3& q, const Point3& a, const Point3& b, const Point3& c) {
    constexpr double slack = 1e-9, flat = 1e-12;
    const Point3 way = q - p, first = b - a, second = c - a, offset = p - a;
    const Point3 normal = way.cross(second), turned = offset.cross(first);
    const double volume = first.dot(normal);
    if (!(std::abs(volume) > flat * way.norm() * first.cross(second).norm())) return false;
    const double u = offset.dot(normal) / volume, v = way.dot(turned) / volume, t = second.dot(turned) / volume;
    return std::min({u, v, 1 - u - v, t, 1 - t}) > slack;
}

}  // namespace restshape
