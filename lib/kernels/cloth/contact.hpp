// Contact of points with bodies in closed form: signed distances, a penalty with a smooth onset, friction by anchors.
//
// Source: docs/theory/cloth.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace restshape {

// Second derivatives are stored as xx yy zz yz xz xy.
constexpr int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

struct Distance {
    double value;        // negative inside
    double gradient[3];  // of length 1
    double hessian[6];
};

// A body of one of five kinds. Rotations are rows: local = R (x - centre).
class Body {
 public:
    enum class Kind { sphere, plane, box, capsule, cylinder };

    static Body sphere(const double* centre, double radius) {
        Body b(Kind::sphere, centre);
        b.radius_ = positive(radius, "radius");
        return b;
    }
    // All on the side that the normal points away from.
    static Body plane(const double* point, const double* normal) {
        Body b(Kind::plane, point);
        const double length = norm(normal);
        if (!(length > 0)) throw std::invalid_argument("the normal of a plane must not be zero");
        for (int a = 0; a < 3; ++a) b.axis_[a] = normal[a] / length;
        return b;
    }
    // Half sizes include the radius of the edges.
    static Body box(const double* centre, const double* half, const double* rotation, double radius) {
        Body b(Kind::box, centre);
        if (radius < 0) throw std::invalid_argument("the radius of a box's edges must not be negative");
        b.radius_ = radius;
        for (int a = 0; a < 3; ++a) b.half_[a] = positive(half[a], "half size") - radius;
        if (*std::min_element(b.half_, b.half_ + 3) < 0)
            throw std::invalid_argument("the radius of a box's edges is larger than a half size");
        std::copy(rotation, rotation + 9, b.rotation_[0]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                double product = 0.0;
                for (int k = 0; k < 3; ++k) product += b.rotation_[i][k] * b.rotation_[j][k];
                if (!(std::abs(product - (i == j)) < 1e-9))
                    throw std::invalid_argument("the rotation of a box is not orthogonal");
            }
        return b;
    }
    static Body capsule(const double* from, const double* to, double radius) {
        Body b(Kind::capsule, from);
        b.radius_ = positive(radius, "radius");
        double along[3];
        for (int a = 0; a < 3; ++a) along[a] = to[a] - from[a];
        b.length_ = norm(along);
        for (int a = 0; a < 3; ++a) b.axis_[a] = b.length_ > 0 ? along[a] / b.length_ : 0.0;
        return b;
    }

    // With flat ends; radius and length include the rounding of its edges.
    static Body cylinder(const double* from, const double* to, double radius, double rounded) {
        double middle[3], along[3];
        for (int a = 0; a < 3; ++a) {
            middle[a] = 0.5 * (from[a] + to[a]);
            along[a] = to[a] - from[a];
        }
        Body b(Kind::cylinder, middle);
        b.radius_ = positive(radius, "radius");
        b.length_ = 0.5 * positive(norm(along), "length");
        if (rounded < 0) throw std::invalid_argument("the radius of a cylinder's edges must not be negative");
        if (rounded > std::min(b.radius_, b.length_))
            throw std::invalid_argument("the radius of a cylinder's edges is larger than its radius or half length");
        b.rounded_ = rounded;
        for (int a = 0; a < 3; ++a) b.axis_[a] = along[a] / (2 * b.length_);
        return b;
    }

    // The smallest radius of curvature of its surface; infinite where it is flat.
    double sharpest() const {
        switch (kind_) {
            case Kind::plane:
                return std::numeric_limits<double>::infinity();
            case Kind::cylinder:
                return rounded_;
            default:
                return radius_;
        }
    }
    // The distance of its surface from the place farthest within it.
    double inner_radius() const {
        switch (kind_) {
            case Kind::plane:
                return std::numeric_limits<double>::infinity();
            case Kind::cylinder:
                return std::min(radius_, length_);
            case Kind::box:
                return *std::min_element(half_, half_ + 3) + radius_;
            default:
                return radius_;
        }
    }

    // Without `curved` the second derivatives are zero.
    Distance distance(const double* x, bool curved = true) const {
        double y[3];
        for (int a = 0; a < 3; ++a) y[a] = x[a] - centre_[a];
        switch (kind_) {
            case Kind::sphere:
                return round(y, nullptr, curved);
            case Kind::plane:
                return flat(dot(y, axis_), axis_);
            case Kind::box:
                return box(y, curved);
            case Kind::cylinder:
                return cylinder(y, curved);
            default:
                return capsule(y, curved);
        }
    }

 private:
    Body(Kind kind, const double* centre) : kind_(kind) { std::copy(centre, centre + 3, centre_); }

    static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static double norm(const double* a) { return std::sqrt(dot(a, a)); }
    static double positive(double value, const char* what) {
        if (!(value > 0)) throw std::invalid_argument(std::string("the ") + what + " of a body must be positive");
        return value;
    }

    static Distance flat(double value, const double* normal) {
        return {value, {normal[0], normal[1], normal[2]}, {0, 0, 0, 0, 0, 0}};
    }

    // Distance from the surface of radius_ about a point, or about a line with this direction: y is normal to it.
    Distance round(const double* y, const double* direction, bool curved) const {
        const double length = norm(y);
        // On the point or line itself any direction leads out.
        if (!(length > 0)) return flat(-radius_, direction ? across(direction).n : up);
        Distance d{length - radius_, {y[0] / length, y[1] / length, y[2] / length}, {}};
        if (!curved) return d;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) {
                const double along = direction ? direction[a] * direction[b] : 0.0;
                d.hessian[voigt[a][b]] = ((a == b) - d.gradient[a] * d.gradient[b] - along) / length;
            }
        return d;
    }

    struct Normal {
        double n[3];
    };
    static Normal across(const double* t) {
        const int k = static_cast<int>(std::min_element(t, t + 3, less_in_size) - t);
        Normal result{{-t[k] * t[0], -t[k] * t[1], -t[k] * t[2]}};
        result.n[k] += 1.0;
        const double length = norm(result.n);
        for (double& c : result.n) c /= length;
        return result;
    }
    static bool less_in_size(double a, double b) { return std::abs(a) < std::abs(b); }

    Distance capsule(const double* y, bool curved) const {
        const double along = dot(y, axis_), at = std::clamp(along, 0.0, length_);
        const double from[3] = {y[0] - at * axis_[0], y[1] - at * axis_[1], y[2] - at * axis_[2]};
        return round(from, at == along && length_ > 0 ? axis_ : nullptr, curved);
    }

    // Outside the core of half sizes half_, the nearest place of it is a corner, or on an edge or a face.
    Distance box(const double* y, bool curved) const {
        double q[3], sign[3];
        int outside = 0, nearest = 0;
        for (int k = 0; k < 3; ++k) {
            const double local = dot(rotation_[k], y);
            sign[k] = local < 0 ? -1.0 : 1.0;
            q[k] = std::abs(local) - half_[k];
            if (q[k] > 0) ++outside;
            if (q[k] > q[nearest]) nearest = k;
        }
        if (outside <= 1) {
            const double* row = rotation_[nearest];
            const double normal[3] = {sign[nearest] * row[0], sign[nearest] * row[1], sign[nearest] * row[2]};
            return flat(q[nearest] - radius_, normal);
        }
        double from[3] = {0, 0, 0};
        const double* direction = nullptr;
        for (int k = 0; k < 3; ++k) {
            if (q[k] > 0)
                for (int a = 0; a < 3; ++a) from[a] += q[k] * sign[k] * rotation_[k][a];
            else
                direction = rotation_[k];
        }
        return round(from, direction, curved);
    }

    // The nearest place of it is on the curved side, on an end, or on the rim between both.
    Distance cylinder(const double* y, bool curved) const {
        const double along = dot(y, axis_), sign = along < 0 ? -1.0 : 1.0;
        const double from[3] = {y[0] - along * axis_[0], y[1] - along * axis_[1], y[2] - along * axis_[2]};
        const double across = norm(from), end = std::abs(along) - length_;
        // Beyond the core: across the axis and along it.
        const double q = across - radius_ + rounded_, p = end + rounded_;
        if (q > 0 && p > 0) return rim(from, across, sign, q, p, curved);
        if (across - radius_ > end) return round(from, axis_, curved);
        const double normal[3] = {sign * axis_[0], sign * axis_[1], sign * axis_[2]};
        return flat(end, normal);
    }

    // Distance from the circle around the core's end, less the rounding: y = from + along the axis, |from| = across.
    Distance rim(const double* from, double across, double sign, double q, double p, bool curved) const {
        const double length = std::hypot(q, p), c = q / length, s = p / length;
        Distance d{length - rounded_, {}, {}};
        for (int a = 0; a < 3; ++a) d.gradient[a] = c * from[a] / across + s * sign * axis_[a];
        if (!curved) return d;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) {
                const double na = from[a] / across, nb = from[b] / across, ta = axis_[a], tb = axis_[b];
                // Along the meridian, and around the axis.
                const double meridian = (s * na - c * sign * ta) * (s * nb - c * sign * tb);
                d.hessian[voigt[a][b]] = meridian / length + c / across * ((a == b) - na * nb - ta * tb);
            }
        return d;
    }

    static constexpr double up[3] = {0, 0, 1};

    Kind kind_;
    double centre_[3];
    double radius_ = 0, length_ = 0, rounded_ = 0;  // of a cylinder length_ is half of it
    double axis_[3] = {0, 0, 0}, half_[3] = {0, 0, 0};
    double rotation_[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

// A function of the distance and its first two derivatives.
struct Ramp {
    double value, slope, curvature;
};

// Energy an area of a penalty of stiffness k [N/m^3] that begins at the distance `thickness` t. Its second derivative
// rises linearly to k at the surface, by e^(16 u) on the way u t below it, so that a corner that bears much is hardly
// deeper than one that bears little, and stays from half of a thickness below it on.
inline Ramp penalty(double distance, double stiffness, double thickness) {
    constexpr double growth = 16.0, most = 0.5;
    const double k = stiffness, t = thickness, s = t - distance;
    if (s <= 0) return {0, 0, 0};
    if (s < t) {
        const double share = s / t;
        return {k * s * s * share / 6, -k * s * share / 2, k * share};
    }
    const double u = std::min(s / t - 1, most), more = std::exp(growth * u);
    const double slope = k * t * (0.5 + (more - 1) / growth), rest = s - t - u * t;
    const double value = k * t * t * (1.0 / 6 + u / 2 + (more - 1 - growth * u) / (growth * growth));
    return {value + slope * rest + k * more * rest * rest / 2, -slope - k * more * rest, k * more};
}

// Adds to a point's potential (x0, gradient, second derivatives; see element_point.hpp) what the body does to it.
// Without `curved` the term of the penalty's force times the curvature of the surface is left out: what stays is
// positive semidefinite.
inline double add_contact(const Body& body, const double* x, double area, double stiffness, double thickness,
                          bool curved, double* potential) {
    const Distance d = body.distance(x, curved);
    const Ramp ramp = penalty(d.value, stiffness * area, thickness);
    if (ramp.curvature == 0.0) return 0.0;
    for (int a = 0; a < 3; ++a) {
        potential[3 + a] += ramp.slope * d.gradient[a];
        for (int b = a; b < 3; ++b) {
            const int k = voigt[a][b];
            potential[6 + k] += ramp.curvature * d.gradient[a] * d.gradient[b];
            if (curved) potential[6 + k] += ramp.slope * d.hessian[k];
        }
    }
    return ramp.value;
}

// The way from an anchor to x along the surface of this normal; returns its length.
inline double slip_of(const double* x, const double* anchor, const double* normal, double* u) {
    double across = 0.0, square = 0.0;
    for (int a = 0; a < 3; ++a) across += (x[a] - anchor[a]) * normal[a];
    for (int a = 0; a < 3; ++a) {
        u[a] = x[a] - anchor[a] - across * normal[a];
        square += u[a] * u[a];
    }
    return std::sqrt(square);
}

// Adds the friction of at most `limit` [N], reached at a slip of length `slip`: force limit (2 y - y^2), y = |u|/slip.
inline double add_friction(const double* x, const double* anchor, const double* normal, double limit, double slip,
                           double* potential) {
    if (!(limit > 0)) return 0.0;
    double u[3];
    const double length = slip_of(x, anchor, normal, u), y = length / slip;
    // Force over length, and the change of the force along u.
    const double ratio = y < 1 ? limit * (2 - y) / slip : limit / length;
    const double change = y < 1 ? limit * 2 * (1 - y) / slip : 0.0;
    for (int a = 0; a < 3; ++a) {
        potential[3 + a] += ratio * u[a];
        for (int b = a; b < 3; ++b) {
            const double along = length > 0 ? u[a] * u[b] / (length * length) : 0.0;
            potential[6 + voigt[a][b]] += ratio * ((a == b) - normal[a] * normal[b]) + (change - ratio) * along;
        }
    }
    return y < 1 ? limit * slip * (y * y - y * y * y / 3) : limit * (length - slip / 3);
}

// Takes the anchor into the surface at x, and after x until the slip is `slip` at most; returns how far it was dragged.
inline double update_friction_anchor(const double* x, const double* normal, double limit, double slip, double* anchor) {
    double u[3], moved = 0.0;
    if (!(limit > 0)) {
        std::copy(x, x + 3, anchor);
        return 0.0;
    }
    const double length = slip_of(x, anchor, normal, u);
    double kept = 1.0;
    if (length > slip) {
        kept = slip / length;
        moved = length - slip;
    }
    for (int a = 0; a < 3; ++a) anchor[a] = x[a] - kept * u[a];
    return moved;
}

}  // namespace restshape
