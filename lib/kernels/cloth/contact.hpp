// Contact of points with bodies: signed distances, a penalty with a smooth onset, friction by anchors.
//
// Source: docs/theory/cloth.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "cloth/grid_distance.hpp"
#include "fem/dual.hpp"

namespace restshape {

// Second derivatives are stored as xx yy zz yz xz xy.
constexpr int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

// Branches are chosen by values alone.
template <int N>
bool operator<(const Dual<N>& a, const Dual<N>& b) {
    return a.v < b.v;
}
template <int N>
bool operator<(const Dual<N>& a, double b) {
    return a.v < b;
}
template <int N>
bool operator>(const Dual<N>& a, const Dual<N>& b) {
    return a.v > b.v;
}
template <int N>
bool operator>(const Dual<N>& a, double b) {
    return a.v > b;
}
template <int N>
bool operator==(const Dual<N>& a, const Dual<N>& b) {
    return a.v == b.v;
}
template <int N>
Dual<N> exp(const Dual<N>& a) {
    const double power = std::exp(a.v);
    return {power, a.d * power};
}
template <int N>
Dual<N> abs(const Dual<N>& a) {
    return a.v < 0 ? -a : a;
}
template <int N>
Dual<N> hypot(const Dual<N>& a, const Dual<N>& b) {
    return sqrt(a * a + b * b);
}

// T is double, or dual where rates are wanted.
template <class T>
struct DistanceOf {
    T value;        // negative inside
    T gradient[3];  // of length 1; nearly so where a grid gives it
    T hessian[6];
};
using Distance = DistanceOf<double>;

enum class Kind { sphere, plane, box, capsule, cylinder, mesh };

// A body of one of six kinds. Rotations are rows: local = R (x - centre).
using std::abs;
using std::hypot;

template <class T>
class BodyOf {
 public:
    // All numbers of one that are constant.
    template <class S>
    explicit BodyOf(const BodyOf<S>& other) : kind_(other.kind_) {
        radius_ = other.radius_, length_ = other.length_, rounded_ = other.rounded_, grid_ = other.grid_;
        for (int a = 0; a < 3; ++a) {
            centre_[a] = other.centre_[a], axis_[a] = other.axis_[a], half_[a] = other.half_[a];
            for (int b = 0; b < 3; ++b) rotation_[a][b] = other.rotation_[a][b];
        }
    }

    static BodyOf sphere(const T* centre, T radius) {
        BodyOf b(Kind::sphere, centre);
        b.radius_ = positive(radius, "radius");
        return b;
    }
    // All on the side that the normal points away from.
    static BodyOf plane(const T* point, const T* normal) {
        BodyOf b(Kind::plane, point);
        const T length = norm(normal);
        if (!(length > 0)) throw std::invalid_argument("the normal of a plane must not be zero");
        for (int a = 0; a < 3; ++a) b.axis_[a] = normal[a] / length;
        return b;
    }
    // Half sizes include the radius of the edges.
    static BodyOf box(const T* centre, const T* half, const T* rotation, T radius) {
        BodyOf b(Kind::box, centre);
        if (radius < 0) throw std::invalid_argument("the radius of a box's edges must not be negative");
        b.radius_ = radius;
        for (int a = 0; a < 3; ++a) b.half_[a] = positive(half[a], "half size") - radius;
        if (*std::min_element(b.half_, b.half_ + 3) < 0)
            throw std::invalid_argument("the radius of a box's edges is larger than a half size");
        b.turn(rotation, "the rotation of a box is not orthogonal");
        return b;
    }
    static BodyOf capsule(const T* from, const T* to, T radius) {
        BodyOf b(Kind::capsule, from);
        b.radius_ = positive(radius, "radius");
        T along[3];
        for (int a = 0; a < 3; ++a) along[a] = to[a] - from[a];
        b.length_ = norm(along);
        for (int a = 0; a < 3; ++a) b.axis_[a] = b.length_ > 0 ? along[a] / b.length_ : 0.0;
        return b;
    }

    // With flat ends; radius and length include the rounding of its edges.
    static BodyOf cylinder(const T* from, const T* to, T radius, T rounded) {
        T middle[3], along[3];
        for (int a = 0; a < 3; ++a) {
            middle[a] = 0.5 * (from[a] + to[a]);
            along[a] = to[a] - from[a];
        }
        BodyOf b(Kind::cylinder, middle);
        b.radius_ = positive(radius, "radius");
        b.length_ = 0.5 * positive(norm(along), "length");
        if (rounded < 0) throw std::invalid_argument("the radius of a cylinder's edges must not be negative");
        if (rounded > std::min(b.radius_, b.length_))
            throw std::invalid_argument("the radius of a cylinder's edges is larger than its radius or half length");
        b.rounded_ = rounded;
        for (int a = 0; a < 3; ++a) b.axis_[a] = along[a] / (2 * b.length_);
        return b;
    }

    // The distance on a grid, in coordinates of the body's own: x = place + scale R^T y.
    static BodyOf mesh(std::shared_ptr<const GridDistance> grid, const T* place, const T* rotation, T scale) {
        BodyOf b(Kind::mesh, place);
        if (!grid) throw std::invalid_argument("a body of triangles needs its grid");
        b.grid_ = std::move(grid);
        b.radius_ = positive(scale, "scale");
        b.turn(rotation, "the rotation of a body is not orthogonal");
        return b;
    }

    // Whether it is convex, with the distance in closed form.
    bool convex() const { return kind_ != Kind::mesh; }
    // A convex body that holds it: itself, or a box.
    BodyOf hull() const {
        if (convex()) return *this;
        T middle[3], half[3];
        const auto& layout = grid_->layout();
        for (int a = 0; a < 3; ++a) {
            middle[a] = centre_[a];
            half[a] = 0.5 * (layout.high[a] - layout.low[a]) * radius_;
            for (int b = 0; b < 3; ++b) middle[a] += 0.5 * (layout.low[b] + layout.high[b]) * radius_ * rotation_[b][a];
        }
        return box(middle, half, rotation_[0], 0.0);
    }
    // How much the distance curves downwards within a radius of a place, at most: not at all of convex bodies.
    double bent(const double* x, double radius) const {
        if (convex()) return 0.0;
        double local[3];
        to_grid(x, local);
        return grid_->bent(local, radius / radius_) / radius_;
    }
    // No gradient of the distance is longer; of a grid, none of those that are measured.
    double slope() const { return convex() ? 1.0 : grid_->layout().slope; }

    // What the distance is smooth beside: cells of its grid; nothing of one in closed form, which has edges.
    double detail() const { return convex() ? 0.0 : grid_->layout().spacing * radius_; }

    // The smallest radius of curvature of its surface; infinite where it is flat.
    T sharpest() const {
        switch (kind_) {
            case Kind::mesh:
                return grid_->layout().sharpest * radius_;
            case Kind::plane:
                return std::numeric_limits<double>::infinity();
            case Kind::cylinder:
                return rounded_;
            default:
                return radius_;
        }
    }
    // The distance of its surface from the place farthest within it.
    T inner_radius() const {
        switch (kind_) {
            case Kind::mesh:
                return grid_->layout().thin * radius_;
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

    // Whether a place is easily seen to be farther away than so much: most places are, and need no distance then.
    bool beyond(const T* x, T far) const {
        T y[3];
        for (int a = 0; a < 3; ++a) y[a] = x[a] - centre_[a];
        const T most = radius_ + far;
        switch (kind_) {
            case Kind::sphere:
                return most > 0 && dot(y, y) > most * most;
            case Kind::plane:
                return dot(y, axis_) > far;
            case Kind::box:
                for (int k = 2; k >= 0; --k)
                    if (abs(dot(rotation_[k], y)) > half_[k] + most) return true;
                return false;
            case Kind::cylinder:
                return abs(dot(y, axis_)) > length_ + far;
            case Kind::mesh: {
                double local[3];
                to_grid(x, local);
                return grid_->beyond(local, value_of(far) / value_of(radius_));
            }
            default:
                const T along = dot(y, axis_), over = along - std::clamp<T>(along, 0.0, length_);
                return most > 0 && dot(y, y) - along * along + over * over > most * most;
        }
    }

    // Without `curved` the second derivatives are zero.
    DistanceOf<T> distance(const T* x, bool curved = true) const {
        T y[3];
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
            case Kind::mesh:
                return mesh(y, curved);
            default:
                return capsule(y, curved);
        }
    }

 private:
    template <class S>
    friend class BodyOf;

    BodyOf(Kind kind, const T* centre) : kind_(kind) { std::copy(centre, centre + 3, centre_); }

    static T dot(const T* a, const T* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static T norm(const T* a) { return square_root(dot(a, a)); }
    static T positive(T value, const char* what) {
        if (!(value > 0)) throw std::invalid_argument(std::string("the ") + what + " of a body must be positive");
        return value;
    }

    // Takes the rows of a turn.
    void turn(const T* rotation, const char* otherwise) {
        std::copy(rotation, rotation + 9, rotation_[0]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                T product = 0.0;
                for (int k = 0; k < 3; ++k) product += rotation_[i][k] * rotation_[j][k];
                if (!(abs(product - (i == j)) < 1e-9)) throw std::invalid_argument(otherwise);
            }
    }
    void to_grid(const T* x, double* local) const {
        double y[3];
        for (int a = 0; a < 3; ++a) y[a] = value_of(x[a]) - value_of(centre_[a]);
        for (int a = 0; a < 3; ++a) {
            const T* row = rotation_[a];
            local[a] =
                (value_of(row[0]) * y[0] + value_of(row[1]) * y[1] + value_of(row[2]) * y[2]) / value_of(radius_);
        }
    }

    // Rates of value and gradient follow from the next derivative; those of the second derivatives are left out.
    DistanceOf<T> mesh(const T* y, bool curved) const {
        constexpr bool with_rates = !std::is_same_v<T, double>;
        T local[3];
        double place[3];
        for (int a = 0; a < 3; ++a) {
            local[a] = dot(rotation_[a], y) / radius_;
            place[a] = value_of(local[a]);
        }
        const GridValue own = grid_->at(place, curved || with_rates);
        T value = own.value, slope[3] = {own.gradient[0], own.gradient[1], own.gradient[2]};
        if constexpr (with_rates)
            for (int a = 0; a < 3; ++a) {
                const T way = local[a] - place[a];
                value += way * own.gradient[a];
                for (int b = 0; b < 3; ++b) slope[b] += way * own.hessian[voigt[a][b]];
            }
        DistanceOf<T> d = flat(value * radius_, slope);
        for (int a = 0; a < 3; ++a)
            d.gradient[a] = rotation_[0][a] * slope[0] + rotation_[1][a] * slope[1] + rotation_[2][a] * slope[2];
        if (!curved) return d;
        T half[3][3];
        for (int i = 0; i < 3; ++i)
            for (int b = 0; b < 3; ++b) {
                half[i][b] = 0.0;
                for (int j = 0; j < 3; ++j) half[i][b] += rotation_[j][b] * own.hessian[voigt[i][j]];
            }
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) {
                T sum = 0.0;
                for (int i = 0; i < 3; ++i) sum += rotation_[i][a] * half[i][b];
                d.hessian[voigt[a][b]] = sum / radius_;
            }
        return d;
    }

    static DistanceOf<T> flat(T value, const T* normal) {
        return {value, {normal[0], normal[1], normal[2]}, {0, 0, 0, 0, 0, 0}};
    }

    // Distance from the surface of radius_ about a point, or about a line with this direction: y is normal to it.
    DistanceOf<T> round(const T* y, const T* direction, bool curved) const {
        const T length = norm(y);
        // On the point or line itself any direction leads out.
        const T up[3] = {0, 0, 1};
        if (!(length > 0)) return flat(-radius_, direction ? across(direction).n : up);
        DistanceOf<T> d{length - radius_, {y[0] / length, y[1] / length, y[2] / length}, {}};
        if (!curved) return d;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) {
                const T along = direction ? direction[a] * direction[b] : 0.0;
                d.hessian[voigt[a][b]] = ((a == b) - d.gradient[a] * d.gradient[b] - along) / length;
            }
        return d;
    }

    struct Normal {
        T n[3];
    };
    static Normal across(const T* t) {
        const int k = static_cast<int>(std::min_element(t, t + 3, less_in_size) - t);
        Normal result{{-t[k] * t[0], -t[k] * t[1], -t[k] * t[2]}};
        result.n[k] += 1.0;
        const T length = norm(result.n);
        for (T& c : result.n) c = c / length;
        return result;
    }
    static bool less_in_size(T a, T b) { return abs(a) < abs(b); }

    DistanceOf<T> capsule(const T* y, bool curved) const {
        const T along = dot(y, axis_), at = std::clamp(along, T(0.0), length_);
        const T from[3] = {y[0] - at * axis_[0], y[1] - at * axis_[1], y[2] - at * axis_[2]};
        return round(from, at == along && length_ > 0 ? axis_ : nullptr, curved);
    }

    // Outside the core of half sizes half_, the nearest place of it is a corner, or on an edge or a face.
    DistanceOf<T> box(const T* y, bool curved) const {
        T q[3], sign[3];
        int outside = 0, nearest = 0;
        for (int k = 0; k < 3; ++k) {
            const T local = dot(rotation_[k], y);
            sign[k] = local < 0 ? -1.0 : 1.0;
            q[k] = abs(local) - half_[k];
            if (q[k] > 0) ++outside;
            if (q[k] > q[nearest]) nearest = k;
        }
        if (outside <= 1) {
            const T* row = rotation_[nearest];
            const T normal[3] = {sign[nearest] * row[0], sign[nearest] * row[1], sign[nearest] * row[2]};
            return flat(q[nearest] - radius_, normal);
        }
        T from[3] = {0, 0, 0};
        const T* direction = nullptr;
        for (int k = 0; k < 3; ++k) {
            if (q[k] > 0)
                for (int a = 0; a < 3; ++a) from[a] += q[k] * sign[k] * rotation_[k][a];
            else
                direction = rotation_[k];
        }
        return round(from, direction, curved);
    }

    // The nearest place of it is on the curved side, on an end, or on the rim between both.
    DistanceOf<T> cylinder(const T* y, bool curved) const {
        const T along = dot(y, axis_), sign = along < 0 ? -1.0 : 1.0;
        const T from[3] = {y[0] - along * axis_[0], y[1] - along * axis_[1], y[2] - along * axis_[2]};
        const T across = norm(from), end = abs(along) - length_;
        // Beyond the core: across the axis and along it.
        const T q = across - radius_ + rounded_, p = end + rounded_;
        if (q > 0 && p > 0) return rim(from, across, sign, q, p, curved);
        if (across - radius_ > end) return round(from, axis_, curved);
        const T normal[3] = {sign * axis_[0], sign * axis_[1], sign * axis_[2]};
        return flat(end, normal);
    }

    // Distance from the circle around the core's end, less the rounding: y = from + along the axis, |from| = across.
    DistanceOf<T> rim(const T* from, T across, T sign, T q, T p, bool curved) const {
        const T length = hypot(q, p), c = q / length, s = p / length;
        DistanceOf<T> d{length - rounded_, {}, {}};
        for (int a = 0; a < 3; ++a) d.gradient[a] = c * from[a] / across + s * sign * axis_[a];
        if (!curved) return d;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) {
                const T na = from[a] / across, nb = from[b] / across, ta = axis_[a], tb = axis_[b];
                // Along the meridian, and around the axis.
                const T meridian = (s * na - c * sign * ta) * (s * nb - c * sign * tb);
                d.hessian[voigt[a][b]] = meridian / length + c / across * ((a == b) - na * nb - ta * tb);
            }
        return d;
    }

    Kind kind_;
    T centre_[3];
    T radius_ = 0, length_ = 0, rounded_ = 0;  // of a cylinder length_ is half of it; of a mesh radius_ is the scale
    T axis_[3] = {0, 0, 0}, half_[3] = {0, 0, 0};
    T rotation_[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::shared_ptr<const GridDistance> grid_;
};

// Makes the gradient a normal of length 1; returns how long it was, which grids alone do not have as 1.
template <class T>
T to_normal(const BodyOf<T>& body, DistanceOf<T>& d) {
    if (body.convex()) return 1.0;
    const T square = d.gradient[0] * d.gradient[0] + d.gradient[1] * d.gradient[1] + d.gradient[2] * d.gradient[2];
    // In the middle of a body any direction leads out.
    if (!(square > T(1e-24))) {
        d.gradient[0] = d.gradient[1] = 0.0, d.gradient[2] = 1.0;
        return 0.0;
    }
    const T length = square_root(square);
    for (T& g : d.gradient) g = g / length;
    return length;
}

using Body = BodyOf<double>;

// A function of the distance and its first two derivatives.
template <class T>
struct Ramp {
    T value, slope, curvature;
};

// Energy an area of a penalty of stiffness k [N/m^3] that begins at the distance `thickness` t. Its second derivative
// rises linearly to k at the surface, by e^(24 u) on the way u t below it, so that a corner that bears much is hardly
// deeper than one that bears little, and stays from a third of a thickness below it on.
template <class T>
Ramp<T> penalty(const T& distance, const T& stiffness, const T& thickness) {
    using std::exp;
    constexpr double growth = 24.0, most = 1.0 / 3.0;
    const T k = stiffness, t = thickness, s = t - distance;
    if (!(s > 0)) return {0, 0, 0};
    if (s < t) {
        const T share = s / t;
        return {k * s * s * share / 6, -k * s * share / 2, k * share};
    }
    const T u = std::min(s / t - 1, T(most)), more = exp(growth * u);
    const T slope = k * t * (0.5 + (more - 1) / growth), rest = s - t - u * t;
    const T value = k * t * t * (1.0 / 6 + u / 2 + (more - 1 - growth * u) / (growth * growth));
    return {value + slope * rest + k * more * rest * rest / 2, -slope - k * more * rest, k * more};
}

// Adds to a point's potential (x0, gradient, second derivatives; see element_point.hpp) what a body at a distance does
// to it. Without `curved` the term of the penalty's force times the curvature of the surface is left out: what stays is
// positive semidefinite.
inline double add_penalty(const Distance& d, double area, double stiffness, double thickness, bool curved,
                          double* potential) {
    const Ramp<double> ramp = penalty(d.value, stiffness * area, thickness);
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
inline double add_contact(const Body& body, const double* x, double area, double stiffness, double thickness,
                          bool curved, double* potential) {
    if (body.beyond(x, thickness)) return 0.0;
    return add_penalty(body.distance(x, curved), area, stiffness, thickness, curved, potential);
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

// Rates of the whole force of a body on a point, friction included, with normal and normal force of the place itself.
//
// All arguments are dual along one direction; without `sticks` friction has not begun.
template <class T>
void add_force(const BodyOf<T>& body, const T* x, const T& area, const T& stiffness, const T& thickness,
               const T& coefficient, const T& slip, const T* anchor, bool sticks, T* force) {
    DistanceOf<T> d = body.distance(x, false);
    T slope = penalty(d.value, stiffness * area, thickness).slope;
    if (slope == T(0.0)) return;
    slope = slope * to_normal(body, d);
    for (int a = 0; a < 3; ++a) force[a] += slope * d.gradient[a];
    if (!sticks) return;
    T across = 0.0, square = 0.0, u[3];
    for (int a = 0; a < 3; ++a) across += (x[a] - anchor[a]) * d.gradient[a];
    for (int a = 0; a < 3; ++a) {
        u[a] = x[a] - anchor[a] - across * d.gradient[a];
        square += u[a] * u[a];
    }
    // Where nothing has slid yet the force over the way is all there is.
    const T length = square > T(0.0) ? square_root(square) : T(0.0), y = length / slip;
    const T limit = -coefficient * slope, ratio = y < T(1.0) ? limit * (2.0 - y) / slip : limit / length;
    for (int a = 0; a < 3; ++a) force[a] += ratio * u[a];
}

}  // namespace restshape
