// Signed distances of bodies over triangles, and how far triangles may go before one falls below a bound.
//
// The signed distance f of a convex set is convex and changes by no more than one goes: f(y) is at least
// f(c) + g.(y - c) with its gradient g at any c, and at least f(c) - |y - c|. Both bounds are used everywhere. Where f
// curves downwards by b at most, as it may beside a grid, the first is lower by b |y - c|^2/2.
// Source: docs/theory/cloth.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/contact.hpp"

namespace restshape {

struct Vec3 {
    double c[3];
    double& operator[](int a) { return c[a]; }
    double operator[](int a) const { return c[a]; }
};
inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}}; }
inline Vec3 operator*(double s, const Vec3& a) { return {{s * a[0], s * a[1], s * a[2]}}; }
inline double inner(const double* a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double size_of(const Vec3& a) { return std::sqrt(inner(a.c, a)); }

// A triangle in space, and its corners in barycentric coordinates of the one that it is a part of.
struct Part {
    Vec3 p[3], b[3];

    static Part whole(const Vec3* p) { return {{p[0], p[1], p[2]}, {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}}; }
    // Halves of its longest side, which begins at the corner that is returned.
    int halve(Part& first, Part& second) const {
        int longest = 0;
        double most = -1.0;
        for (int i = 0; i < 3; ++i) {
            const Vec3 side = p[(i + 1) % 3] - p[i];
            const double square = inner(side.c, side);
            if (square > most) {
                most = square;
                longest = i;
            }
        }
        const int i = longest, j = (longest + 1) % 3;
        first = second = *this;
        first.p[j] = second.p[i] = 0.5 * (p[i] + p[j]);
        first.b[j] = second.b[i] = 0.5 * (b[i] + b[j]);
        return i;
    }
};

// The least distance over a triangle, within a tolerance, and where it is.
struct Lowest {
    double value, bound;  // one that is there, and one that none is below
    double b[3];
};

// How much lower the distance may be within a reach of a place than there: the least slope times the way is given.
inline double below(const Body& body, const double* place, double slope, double square) {
    const double reach = std::sqrt(square);
    if (body.convex()) return std::max(slope, -reach);
    const double bent = body.bent(place, reach);
    const double steepest = -body.slope() * reach;
    return std::isfinite(bent) ? std::max(slope - 0.5 * bent * square, steepest) : steepest;
}

// A lower bound of the distance over a part, from its centroid; `best` takes what is there.
inline double bound_of(const Body& body, const Part& part, Lowest& best) {
    const Vec3 b = (1.0 / 3.0) * (part.b[0] + part.b[1] + part.b[2]);
    const Vec3 centre = (1.0 / 3.0) * (part.p[0] + part.p[1] + part.p[2]);
    const Distance d = body.distance(centre.c, false);
    if (d.value < best.value) {
        best.value = d.value;
        std::copy(b.c, b.c + 3, best.b);
    }
    double slope = 0.0, farthest = 0.0;
    for (const Vec3& p : part.p) {
        const Vec3 way = p - centre;
        slope = std::min(slope, inner(d.gradient, way));
        farthest = std::max(farthest, inner(way.c, way));
    }
    return d.value + below(body, centre.c, slope, farthest);
}

// Parts are halved until none can hold a distance below what is found, less the tolerance. Of no interest is what is
// not below `enough`: the value is then some that is there, the bound one that is no less than `enough`.
inline Lowest lowest_on(const Body& body, const Vec3* corners, double tolerance, double enough,
                        const double* at_corners) {
    constexpr int most = 64, patience = 4000;
    struct Open {
        Part part;
        double bound;
    } stack[most];
    Lowest best{std::numeric_limits<double>::infinity(), 0.0, {}};
    for (int i = 0; i < 3; ++i) {
        if (at_corners[i] < best.value) {
            best.value = at_corners[i];
            for (int k = 0; k < 3; ++k) best.b[k] = k == i;
        }
    }
    const auto goal = [&] { return std::min(best.value - tolerance, enough); };
    int open = 0;
    double bound = std::numeric_limits<double>::infinity();
    stack[open].part = Part::whole(corners);
    stack[open].bound = bound_of(body, stack[open].part, best);
    ++open;
    for (int k = 0; open && k < patience; ++k) {
        const Open now = stack[--open];
        if (now.bound >= goal()) {
            bound = std::min(bound, now.bound);
            continue;
        }
        if (open + 2 > most) {
            bound = std::min(bound, now.bound);
            continue;
        }
        Open halves[2];
        now.part.halve(halves[0].part, halves[1].part);
        for (Open& half : halves) half.bound = std::max(now.bound, bound_of(body, half.part, best));
        // The more promising one comes next.
        const int last = halves[0].bound < halves[1].bound ? 0 : 1;
        stack[open++] = halves[1 - last];
        stack[open++] = halves[last];
    }
    for (int k = 0; k < open; ++k) bound = std::min(bound, stack[k].bound);
    best.bound = std::min(bound, best.value);
    return best;
}
inline Lowest lowest_on(const Body& body, const Vec3* corners, double tolerance,
                        double enough = std::numeric_limits<double>::infinity()) {
    double at_corners[3];
    for (int i = 0; i < 3; ++i) at_corners[i] = body.distance(corners[i].c, false).value;
    return lowest_on(body, corners, tolerance, enough, at_corners);
}

// Whether no distance over a triangle is below a level, which is easily seen of most: parts are halved until none can
// hold one. Otherwise, or where that takes many parts, it is false.
inline bool clears(const Body& body, const Vec3* corners, double level) {
    constexpr int most = 16, patience = 32;
    Part stack[most] = {Part::whole(corners)};
    Lowest found{std::numeric_limits<double>::infinity(), 0.0, {}};
    for (int k = 0, open = 1; open; ++k) {
        const Part now = stack[--open];
        const bool clear = bound_of(body, now, found) >= level;
        if (found.value < level || (!clear && (k >= patience || open + 2 > most))) return false;
        if (clear) continue;
        now.halve(stack[open], stack[open + 1]);
        open += 2;
    }
    return true;
}

// The share of a part of the way d that a triangle at `now` may go: its places stay on the far side of the plane at the
// lowest one, less what the distance curves downwards.
inline double allowed_along(const Body& body, const Vec3& at, const Distance& there, const Vec3* now, const Vec3* d,
                            double part, double least) {
    double allowed = part, drop = 0.0;
    if (!body.convex()) {
        double farthest = 0.0;
        for (int i = 0; i < 3; ++i)
            for (const double end : {0.0, part}) {
                const Vec3 way = now[i] + end * d[i] - at;
                farthest = std::max(farthest, inner(way.c, way));
            }
        drop = 0.5 * body.bent(at.c, std::sqrt(farthest)) * farthest;
        if (!std::isfinite(drop)) return 0.0;
    }
    for (int i = 0; i < 3; ++i) {
        const double height = there.value + inner(there.gradient, now[i] - at) - least - drop;
        const double rate = inner(there.gradient, d[i]);
        if (height <= 0.0)
            allowed = 0.0;
        else if (rate < 0.0)
            allowed = std::min(allowed, -height / rate);
    }
    return allowed;
}

// The largest share of the way d that a triangle's corners p may go without its distance falling below `floor`, or,
// where it is nearly there, below what it has by more than `deeper`. Conservative: each advance is one that the slope
// of the distance at the lowest place, or its Lipschitz constant, allows.
inline double triangle_share(const Body& body, const Vec3* p, const Vec3* d, double floor, double deeper, double bottom,
                             double tolerance) {
    double longest = 0.0;
    for (int i = 0; i < 3; ++i) longest = std::max(longest, inner(d[i].c, d[i]));
    longest = std::sqrt(longest);
    const Vec3 centre = (1.0 / 3.0) * (p[0] + p[1] + p[2]);
    double slope = 0.0, farthest = 0.0;
    Vec3 ways[6];
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const Vec3 way = ways[2 * i + end] = p[i] + static_cast<double>(end) * d[i] - centre;
            farthest = std::max(farthest, inner(way.c, way));
        }
    if (body.beyond(centre.c, floor + std::sqrt(farthest))) return 1.0;
    const Distance middle = body.distance(centre.c, false);
    for (const Vec3& way : ways) slope = std::min(slope, inner(middle.gradient, way));
    if (middle.value + below(body, centre.c, slope, farthest) >= floor) return 1.0;
    // No place gets lower by more than the longest way of a corner times the steepest slope.
    if (clears(body, p, floor + body.slope() * longest)) return 1.0;
    double t = 0.0, least = floor;
    for (int k = 0; k < 200; ++k) {
        const Vec3 now[3] = {p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]};
        const Lowest low =
            lowest_on(body, now, tolerance, k ? std::numeric_limits<double>::infinity() : floor + deeper);
        // Half of what is left to the bottom, at most: it is never reached.
        if (k == 0)
            least = std::min(floor,
                             low.value > bottom ? std::max(low.value - deeper, 0.5 * (low.value + bottom)) : low.value);
        const double spare = low.bound - least;
        if (k && low.value - least <= 2.0 * tolerance) return t;
        double advance = spare > 0.0 ? spare / (body.slope() * longest) : 0.0;
        // Beyond the tangent plane at the lowest place the triangle is not either.
        const Vec3 at = low.b[0] * now[0] + low.b[1] * now[1] + low.b[2] * now[2];
        const Distance there = body.distance(at.c, false);
        double allowed = 0.0;
        // Where the distance curves downwards a shorter way may be allowed when the whole one is not.
        for (double way = 1.0; allowed == 0.0 && way > (body.convex() ? 0.5 : 1e-3); way *= 0.25)
            allowed = allowed_along(body, at, there, now, d, way, least);
        advance = std::max(advance, allowed);
        t += advance;
        if (t >= 1.0) return 1.0;
        if (!(advance > 1e-9)) return t;
    }
    return t;
}

}  // namespace restshape
