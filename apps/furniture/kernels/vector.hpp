// Vectors, matrices and finite rotations in space over any scalar, dual numbers too.
#pragma once

#include <array>
#include <cmath>

#include "fem/dual.hpp"

namespace restshape::planks {

template <class T>
using V3 = std::array<T, 3>;
template <class T>
using M3 = std::array<T, 9>;  // row by row

inline double value(double a) { return a; }
template <int N>
double value(const Dual<N>& a) {
    return a.v;
}

template <class A, class B>
V3<Common<A, B>> operator+(const V3<A>& a, const V3<B>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class A, class B>
V3<Common<A, B>> operator-(const V3<A>& a, const V3<B>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class A, class B>
V3<Common<A, B>> scaled(const V3<A>& a, const B& s) {
    return {a[0] * s, a[1] * s, a[2] * s};
}
template <class A, class B>
Common<A, B> dot(const V3<A>& a, const V3<B>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class A, class B>
V3<Common<A, B>> cross(const V3<A>& a, const V3<B>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class A, class B>
V3<Common<A, B>> times(const M3<A>& m, const V3<B>& a) {
    return {m[0] * a[0] + m[1] * a[1] + m[2] * a[2], m[3] * a[0] + m[4] * a[1] + m[5] * a[2],
            m[6] * a[0] + m[7] * a[1] + m[8] * a[2]};
}
template <class A, class B>
V3<Common<A, B>> transposed_times(const M3<A>& m, const V3<B>& a) {
    return {m[0] * a[0] + m[3] * a[1] + m[6] * a[2], m[1] * a[0] + m[4] * a[1] + m[7] * a[2],
            m[2] * a[0] + m[5] * a[1] + m[8] * a[2]};
}
template <class T>
V3<T> column(const M3<T>& m, int k) {
    return {m[k], m[3 + k], m[6 + k]};
}

// The rotation of a rotation vector less the unit matrix, and the matrix that takes a change of the vector to the
// small rotation in space that it makes.
template <class T>
struct Turn {
    M3<T> less_one, rate;
};

// a [w]x + b [w]x^2, and 1 on the diagonal if `one`.
template <class T>
M3<T> spun(const V3<T>& w, const T& s, const T& a, const T& b, double one) {
    M3<T> m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[3 * i + j] = b * (w[i] * w[j]);
    const V3<T> aw = scaled(w, a);
    const T diagonal = b * s;
    for (int i = 0; i < 3; ++i) m[4 * i] = m[4 * i] - diagonal + one;
    m[1] -= aw[2];
    m[2] += aw[1];
    m[3] += aw[2];
    m[5] -= aw[0];
    m[6] -= aw[1];
    m[7] += aw[0];
    return m;
}

// Parts by which each term of the series of turns is less than the one before it.
constexpr int most_turn_terms = 18;
constexpr auto turn_terms = [] {
    std::array<std::array<double, most_turn_terms + 1>, 3> terms{};
    for (int order = 1; order <= 3; ++order)
        for (int k = 1; k <= most_turn_terms; ++k)
            terms[order - 1][k] = 1.0 / ((2.0 * k + order) * (2.0 * k + order - 1.0));
    return terms;
}();

// The series have no root and no quotient, so their derivatives are right at 0; they hold up to half a turn.
template <class T>
Turn<T> turn(const V3<T>& w) {
    const T s = dot(w, w);
    const int terms = value(s) < 1e-4 ? 4 : value(s) < 1.0 ? 9 : most_turn_terms;
    T series[3];
    for (int order = 1; order <= 3; ++order) {
        T sum(1.0);
        for (int k = terms; k > 0; --k) sum = 1.0 - sum * s * turn_terms[order - 1][k];
        series[order - 1] = order == 3 ? sum * (1.0 / 6.0) : order == 2 ? sum * 0.5 : sum;
    }
    return {spun(w, s, series[0], series[1], 0.0), spun(w, s, series[1], series[2], 1.0)};
}

// The rotation vector of at most half a turn that makes the same rotation.
template <class T>
V3<T> unwound(const V3<T>& w) {
    constexpr double pi = 3.14159265358979323846;
    const T s = dot(w, w);
    if (!(value(s) > pi * pi)) return w;
    using std::sqrt;
    const T angle = sqrt(s);
    return scaled(w, 1.0 - (2.0 * pi * std::round(value(angle) / (2.0 * pi))) / angle);
}

template <class A, class B>
V3<Common<A, B>> turned(const Turn<A>& t, const V3<B>& a) {
    return a + times(t.less_one, a);
}

}  // namespace restshape::planks
