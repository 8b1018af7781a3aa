// Points of the plane, and what an outline asks of them.
#pragma once

namespace restshape::outline {

struct Point {
    double x, y;
};

inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
inline double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }

}  // namespace restshape::outline
