// What joints and contacts do to their planks: gradients of the energy of docs/theory/furniture.md.
#pragma once

#include "law.hpp"
#include "shape.hpp"

namespace restshape::planks {

template <class T>
struct Place {
    V3<T> u;
    Turn<T> t;
};

template <class T>
Place<T> place_of(const T* x) {
    return {{x[0], x[1], x[2]}, turn(V3<T>{x[3], x[4], x[5]})};
}

// Twice the axial vector of a matrix.
template <class T>
V3<T> axial2(const M3<T>& m) {
    return {m[7] - m[5], m[2] - m[6], m[3] - m[1]};
}

// How far a joint opens: d^t [m] and d^r [rad].
template <class T, class S>
void opening(const Place<T>& a, const Place<T>& b, const V3<S>& arm_a, const V3<S>& arm_b, V3<T>& dt, V3<T>& dr) {
    const V3<T> da = a.u + times(a.t.less_one, arm_a), db = b.u + times(b.t.less_one, arm_b);
    dt = da - db;
    // R_a^T R_b - 1, less what is symmetric in it.
    M3<T> m;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            T sum = a.t.less_one[3 * c + r] + b.t.less_one[3 * r + c];
            for (int k = 0; k < 3; ++k) sum += a.t.less_one[3 * k + r] * b.t.less_one[3 * k + c];
            m[3 * r + c] = sum;
        }
    dr = scaled(axial2(m), 0.5);
}

// Adds the gradient of h_t . d^t + h_r . d^r with respect to u and the rotation vector of both planks.
template <class T, class S>
void joint_gradient(const Place<T>& a, const Place<T>& b, const V3<S>& arm_a, const V3<S>& arm_b, const V3<T>& ht,
                    const V3<T>& hr, T* ra, T* rb) {
    V3<T> rows[3];  // R_a [h_r]x R_b^T
    V3<T> bent[3];
    for (int c = 0; c < 3; ++c) {
        V3<T> row{b.t.less_one[3 * c], b.t.less_one[3 * c + 1], b.t.less_one[3 * c + 2]};
        row[c] += 1.0;
        bent[c] = cross(hr, row);
    }
    for (int c = 0; c < 3; ++c) rows[c] = turned(a.t, bent[c]);
    const M3<T> m{rows[0][0], rows[1][0], rows[2][0], rows[0][1], rows[1][1],
                  rows[2][1], rows[0][2], rows[1][2], rows[2][2]};
    const V3<T> moment = scaled(axial2(m), 0.5);
    const V3<T> ma = transposed_times(a.t.rate, cross(turned(a.t, arm_a), ht) - moment);
    const V3<T> mb = transposed_times(b.t.rate, moment - cross(turned(b.t, arm_b), ht));
    for (int k = 0; k < 3; ++k) {
        ra[k] += ht[k], ra[3 + k] += ma[k];
        rb[k] -= ht[k], rb[3 + k] += mb[k];
    }
}

// Adds the gradient of -force . displacement of the point at the end of an arm.
template <class T, class S, class F>
void force_gradient(const Place<T>& a, const V3<S>& arm, const V3<F>& force, T* r) {
    const V3<T> m = transposed_times(a.t.rate, cross(turned(a.t, arm), force));
    for (int k = 0; k < 3; ++k) r[k] -= force[k], r[3 + k] -= m[k];
}

// The force of a contact on its plank where its point is displaced by v from its place on the plane. A mu of 0 has no
// tangential spring in any law.
template <class T>
V3<T> contact_force(const V3<T>& v, const V3<double>& n, double mu, double k, Law law, double bound = 0.0) {
    using std::sqrt;
    const T pressed = dot(v, n) * -k;
    const bool apart = law != Law::bilateral && value(pressed) <= 0.0;
    if (apart && law == Law::unilateral) return {T(0.0), T(0.0), T(0.0)};
    V3<T> force = scaled(V3<double>(n), apart ? T(0.0) : pressed);
    if (mu == 0.0) return force;
    V3<T> along;
    for (int c = 0; c < 3; ++c) along[c] = v[c] * -k - n[c] * pressed;
    if (law != Law::bilateral) {
        const T size2 = dot(along, along), most = law == Law::bounded ? T(bound) : pressed * mu;
        if (value(size2) > value(most) * value(most)) along = scaled(along, most / sqrt(size2));
    }
    return force + along;
}

// The stiffness of such a contact, less the derivative of its force by v.
inline M3<double> contact_stiffness(const V3<double>& v, const V3<double>& n, double mu, double k, Law law,
                                    double bound = 0.0) {
    const double pressed = dot(v, n) * -k;
    const bool apart = law != Law::bilateral && pressed <= 0.0;
    M3<double> stiffness{};
    if (apart && law == Law::unilateral) return stiffness;
    double across = 0.0;  // of what is normal to n, but along t
    V3<double> t{0.0, 0.0, 0.0};
    if (mu != 0.0) {
        across = k;
        const V3<double> along = scaled(v + scaled(n, pressed / k), -k);
        const double size2 = dot(along, along), most = law == Law::bounded ? bound : mu * pressed;
        if (law != Law::bilateral && size2 > most * most) {
            const double size = std::sqrt(size2);
            across = k * most / size;
            t = scaled(along, 1.0 / size);
        }
    }
    const double along_n = (apart ? 0.0 : k) - across, falls = law == Law::unilateral ? mu * k : 0.0;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            stiffness[3 * r + c] = along_n * n[r] * n[c] - across * t[r] * t[c] + falls * t[r] * n[c];
        stiffness[4 * r] += across;
    }
    return stiffness;
}

}  // namespace restshape::planks
