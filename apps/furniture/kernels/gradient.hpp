// The gradient of a piece's energy, over numbers and over dual ones.
#pragma once

#include "equilibrium.hpp"

namespace restshape::planks {

template <class T>
void Equilibrium::gradient(const Shape<T>& shape, int load_case, Law law, const T* x, T* r, T* openings,
                           const T* joint_forces) const {
    const int n = P.count();
    static thread_local std::vector<Place<T>> at;
    at.resize(n);
    for (int i = 0; i < n; ++i) at[i] = place_of(x + 6 * i);
    std::fill(r, r + 6 * n, T(0.0));
    for (size_t k = 0; k < P.joints.size(); ++k) {
        const int i = P.joints[k].i, j = P.joints[k].j;
        V3<T> dt, dr;
        opening(at[i], at[j], shape.joints[k].arm_i, shape.joints[k].arm_j, dt, dr);
        for (int a = 0; openings && a < 3; ++a) openings[6 * k + a] = dt[a], openings[6 * k + 3 + a] = dr[a];
        V3<T> ht = scaled(dt, joint_t()), hr = scaled(dr, joint_r());
        for (int a = 0; joint_forces && a < 3; ++a)
            ht[a] = joint_forces[6 * k + a], hr[a] = joint_forces[6 * k + 3 + a];
        joint_gradient(at[i], at[j], shape.joints[k].arm_i, shape.joints[k].arm_j, ht, hr, r + 6 * i, r + 6 * j);
    }
    for (size_t k = 0; k < shape.contacts.size(); ++k) {
        const auto& contact = shape.contacts[k];
        const Place<T>& a = at[contact.plank];
        const V3<T> v = a.u + times(a.t.less_one, contact.arm);
        force_gradient(a, contact.arm, contact_force(v, contact.normal, contact.mu, floor(), law, bound(law, k)),
                       r + 6 * contact.plank);
    }
    for (int i = 0; i < n; ++i)
        for (int a = 0; carried(i) && a < 3; ++a) r[6 * i + a] -= shape.mass[i] * P.gravity[a];
    for (size_t k = 0; k < P.loads.size(); ++k)
        if (const int i = P.loads[k].plank; carried(i))
            force_gradient(at[i], shape.load_arms[k], P.cases[load_case][k], r + 6 * i);
    for (const Part& part : parts_)
        for (const auto& q : part.free) {
            T along(0.0);
            for (int a = 0; a < 6; ++a) along += x[6 * part.carrier + a] * q[a];
            for (int a = 0; a < 6; ++a) r[6 * part.carrier + a] += along * (q[a] * floor());
        }
}

}  // namespace restshape::planks
