// Forward-mode dual numbers: a value and its derivatives in N directions, one SIMD lane a direction.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

namespace restshape {

// Lanes are padded to whole vector registers: 6 derivatives in 8 lanes are one instruction instead of three.
constexpr int padded_lanes(int n) { return n <= 2 ? n : n <= 4 ? 4 : (n + 7) / 8 * 8; }

template <int N>
struct Dual {
    static constexpr int lanes = padded_lanes(N);
    using Lanes = Eigen::Array<double, lanes, 1>;

    double v;
    Lanes d;

    Dual() = default;
    Dual(double value) : v(value), d(Lanes::Zero()) {}  // NOLINT: constants mix freely with duals
    Dual(double value, const Lanes& derivative) : v(value), d(derivative) {}

    // The k-th independent variable.
    static Dual seed(double value, int k) {
        Dual s(value);
        s.d[k] = 1.0;
        return s;
    }

    Dual& operator+=(const Dual& o) {
        v += o.v;
        d += o.d;
        return *this;
    }
    Dual& operator-=(const Dual& o) {
        v -= o.v;
        d -= o.d;
        return *this;
    }
    Dual& operator+=(double c) {
        v += c;
        return *this;
    }
    Dual& operator-=(double c) {
        v -= c;
        return *this;
    }
    Dual& operator*=(double c) {
        v *= c;
        d *= c;
        return *this;
    }
    Dual& operator*=(const Dual& o) { return *this = *this * o; }

    friend Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
    friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
    friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
    friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.d * b.v + b.d * a.v}; }
    friend Dual operator/(const Dual& a, const Dual& b) {
        const double inverse = 1.0 / b.v, q = a.v * inverse;
        return {q, (a.d - b.d * q) * inverse};
    }
    friend Dual operator+(const Dual& a, double c) { return {a.v + c, a.d}; }
    friend Dual operator-(const Dual& a, double c) { return {a.v - c, a.d}; }
    friend Dual operator*(const Dual& a, double c) { return {a.v * c, a.d * c}; }
    friend Dual operator/(const Dual& a, double c) { return a * (1.0 / c); }
    friend Dual operator+(double c, const Dual& a) { return a + c; }
    friend Dual operator-(double c, const Dual& a) { return {c - a.v, -a.d}; }
    friend Dual operator*(double c, const Dual& a) { return a * c; }
    friend Dual operator/(double c, const Dual& a) {
        const double inverse = 1.0 / a.v, q = c * inverse;
        return {q, a.d * (-q * inverse)};
    }
    friend Dual sqrt(const Dual& a) {
        const double root = std::sqrt(a.v);
        return {root, a.d * (0.5 / root)};
    }
    friend Dual atan2(const Dual& y, const Dual& x) {
        const double inverse = 1.0 / (x.v * x.v + y.v * y.v);
        return {std::atan2(y.v, x.v), (y.d * x.v - x.d * y.v) * inverse};
    }
};

// The value alone, by which branches are chosen.
inline double value_of(double a) { return a; }
template <int N>
double value_of(const Dual<N>& a) {
    return a.v;
}

// For numbers that may also be packs.
template <class S>
S square_root(const S& a) {
    using std::sqrt;
    return sqrt(a);
}

// The scalar that a product of the two has: double with double, otherwise the dual one.
template <class A, class B>
using Common = std::decay_t<decltype(std::declval<A>() * std::declval<B>())>;

}  // namespace restshape
