// The least signed distance over a triangle beside a body whose distance is smooth, by quadratics.
//
// Source: docs/theory/cloth.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/triangle_distance.hpp"

namespace restshape {

// A part of a triangle, with the distances at its corners and a bound that none over it is below.
struct KnownPart {
    Part part;
    double at_corners[3], bound;
};

// The quadratic that has value, slope and curvature of a distance at a place, over a triangle: p0 + s (p1 - p0) + t (p2
// - p0).
class TriangleQuadratic {
 public:
    TriangleQuadratic(const Distance& d, const Vec3& place, const Vec3* p) {
        const Vec3 from = p[0] - place, first = p[1] - p[0], second = p[2] - p[0];
        const Vec3 bent = times(d.hessian, from), bent_first = times(d.hessian, first);
        const Vec3 bent_second = times(d.hessian, second);
        value_ = d.value + inner(d.gradient, from) + 0.5 * inner(bent.c, from);
        slope_[0] = inner(d.gradient, first) + inner(bent.c, first);
        slope_[1] = inner(d.gradient, second) + inner(bent.c, second);
        curvature_[0] = inner(bent_first.c, first);
        curvature_[1] = inner(bent_first.c, second);
        curvature_[2] = inner(bent_second.c, second);
    }

    double at(double s, double t) const {
        return value_ + s * (slope_[0] + 0.5 * s * curvature_[0] + t * curvature_[1]) +
               t * (slope_[1] + 0.5 * t * curvature_[2]);
    }

    // Sets barycentric coordinates to those of its least value over the triangle; returns that.
    double least(double* b) const {
        double best = std::numeric_limits<double>::infinity();
        const auto take = [&](double s, double t) {
            if (!(s >= 0.0 && t >= 0.0 && s + t <= 1.0) || !(at(s, t) < best)) return;
            best = at(s, t);
            b[0] = 1.0 - s - t, b[1] = s, b[2] = t;
        };
        for (const double s : {0.0, 1.0}) take(s, 0.0);
        take(0.0, 1.0);
        const double xx = curvature_[0], xy = curvature_[1], yy = curvature_[2], det = xx * yy - xy * xy;
        if (det > 0.0) take((xy * slope_[1] - yy * slope_[0]) / det, (xy * slope_[0] - xx * slope_[1]) / det);
        if (xx > 0.0) take(-slope_[0] / xx, 0.0);
        if (yy > 0.0) take(0.0, -slope_[1] / yy);
        // From the second corner to the third.
        const double along = slope_[1] - slope_[0] + xy - xx, across = xx - 2.0 * xy + yy;
        if (across > 0.0) take(1.0 + along / across, -along / across);
        return best;
    }

 private:
    static Vec3 times(const double* h, const Vec3& a) {
        Vec3 found{};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) found[i] += h[voigt[i][j]] * a[j];
        return found;
    }

    double value_, slope_[2], curvature_[3];
};

// The same as `lowest_on`, where the distance is smooth: parts are halved until the quadratic at their middle has the
// distances of their corners within the tolerance, and then it has the least one. Parts wider than `widest` are halved
// in any case, for what is small beside them may lie between. The bound is no more than that.
inline Lowest smooth_lowest(const Body& body, const Vec3* corners, double tolerance, double widest, double enough,
                            const double* at_corners) {
    constexpr int most = 64, patience = 4000;
    KnownPart stack[most];
    Lowest best{std::numeric_limits<double>::infinity(), 0.0, {}};
    const auto take = [&](double value, const Vec3& b) {
        if (!(value < best.value)) return;
        best.value = value;
        std::copy(b.c, b.c + 3, best.b);
    };
    stack[0] = {Part::whole(corners), {at_corners[0], at_corners[1], at_corners[2]}, -best.value};
    for (int i = 0; i < 3; ++i) take(at_corners[i], stack[0].part.b[i]);
    for (int k = 0, open = 1; open && k < patience; ++k) {
        const KnownPart now = stack[--open];
        const auto goal = [&] { return std::min(best.value - tolerance, enough); };
        if (now.bound >= goal()) continue;
        const Part& part = now.part;
        const Vec3 centre = (1.0 / 3.0) * (part.p[0] + part.p[1] + part.p[2]);
        const Distance d = body.distance(centre.c);
        take(d.value, (1.0 / 3.0) * (part.b[0] + part.b[1] + part.b[2]));
        double slope = 0.0, farthest = 0.0;
        for (const Vec3& p : part.p) {
            const Vec3 way = p - centre;
            slope = std::min(slope, inner(d.gradient, way));
            farthest = std::max(farthest, inner(way.c, way));
        }
        const double bound = std::max(now.bound, d.value + below(body, centre.c, slope, farthest));
        if (bound >= goal()) continue;
        const TriangleQuadratic quadratic(d, centre, part.p);
        double error = 0.0;
        for (int i = 0; i < 3; ++i) error = std::max(error, std::abs(quadratic.at(i == 1, i == 2) - now.at_corners[i]));
        if (farthest <= widest * widest && error <= tolerance) {
            double share[3] = {1.0, 0.0, 0.0};
            if (quadratic.least(share) < goal()) {
                const auto between = [&](const Vec3* v) { return share[0] * v[0] + share[1] * v[1] + share[2] * v[2]; };
                take(body.distance(between(part.p).c, false).value, between(part.b));
            }
            continue;
        }
        if (open + 2 > most) continue;
        KnownPart &first = stack[open], &second = stack[open + 1];
        first = second = {part, {now.at_corners[0], now.at_corners[1], now.at_corners[2]}, bound};
        const int side = part.halve(first.part, second.part), j = (side + 1) % 3;
        first.at_corners[j] = second.at_corners[side] = body.distance(first.part.p[j].c, false).value;
        take(first.at_corners[j], first.part.b[j]);
        open += 2;
    }
    best.bound = best.value - tolerance;
    return best;
}

}  // namespace restshape
