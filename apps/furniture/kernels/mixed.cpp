// The mixed system's pattern, residual and tangent.
#include "mixed.hpp"

#include <algorithm>

#include "gradient.hpp"

namespace restshape::planks {

Mixed::Mixed(const State& state) : S(state), P(state.piece), nj_(P.joints.size()), at_(P.count()) {
    const auto& order = S.equilibrium.blocks().order();
    for (size_t k = 0; k < order.size(); ++k) at_[order[k]] = 6 * (nj_ + static_cast<int>(k));
    links_.resize(P.count());
    for (int i = 0; i < P.count(); ++i) links_[i].push_back(i);
    for (const JointSpec& joint : P.joints) {
        link(joint.i, joint.j), link(joint.j, joint.i);
    }
    build();
}

double Mixed::stiffness(int k) const { return k % 6 < 3 ? S.equilibrium.joint_t() : S.equilibrium.joint_r(); }

void Mixed::residual(int load_case, Law law, const double* z, double* out) const {
    const std::vector<double> x = part(z);
    std::vector<double> r(6 * P.count()), d(6 * nj_);
    S.equilibrium.gradient(S.shape, load_case, law, x.data(), r.data(), d.data(), z);
    for (int k = 0; k < 6 * nj_; ++k) out[k] = d[k] * stiffness(k) - z[k];
    for (int i = 0; i < P.count(); ++i) std::copy_n(&r[6 * i], 6, out + at_[i]);
}

void Mixed::tangent(int load_case, Law law, const double* z, double* values, double shift) const {
    std::fill_n(values, columns_.size(), 0.0);
    for (int k = 0; k < 6 * nj_; ++k) put(values, k, k, -1.0);
    const std::vector<double> x = part(z);
    for (int k = 0; k < nj_; ++k) joint(k, z, x.data(), values);
    plank_terms(load_case, law, x.data(), values);
    for (int i = 0; i < P.count(); ++i)
        for (int a = 0; a < 6; ++a) put(values, at_[i] + a, at_[i] + a, shift * stiffness(a));
}

double Mixed::energy(int load_case, const double* z) const {
    return S.equilibrium.energy(S.shape, load_case, part(z).data(), z);
}

std::vector<double> Mixed::join(int load_case) const {
    std::vector<double> z(size());
    const std::vector<double> d = S.equilibrium.openings(S.shape, S.cases.at(load_case).x);
    for (int k = 0; k < 6 * nj_; ++k) z[k] = d[k] * stiffness(k);
    const auto& x = S.cases.at(load_case).x;
    for (int i = 0; i < P.count(); ++i) std::copy_n(&x[6 * i], 6, &z[at_[i]]);
    return z;
}

std::vector<double> Mixed::part(const double* z) const {
    std::vector<double> x(6 * P.count());
    for (int i = 0; i < P.count(); ++i) std::copy_n(z + at_[i], 6, &x[6 * i]);
    return x;
}

void Mixed::link(int i, int j) {
    if (std::find(links_[i].begin(), links_[i].end(), j) == links_[i].end()) links_[i].push_back(j);
}

void Mixed::build() {
    std::vector<std::vector<int>> columns(size());
    const auto block = [&](int r, int c) {
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < 6; ++b) columns[r + a].push_back(c + b);
    };
    for (int k = 0; k < nj_; ++k) {
        for (int a = 0; a < 6; ++a) columns[6 * k + a].push_back(6 * k + a);
        for (int i : {P.joints[k].i, P.joints[k].j}) block(6 * k, at_[i]), block(at_[i], 6 * k);
    }
    for (int i = 0; i < P.count(); ++i)
        for (int j : links_[i]) block(at_[i], at_[j]);
    rows_.push_back(0);
    for (auto& row : columns) {
        std::sort(row.begin(), row.end());
        columns_.insert(columns_.end(), row.begin(), row.end());
        rows_.push_back(static_cast<int>(columns_.size()));
    }
}

double* Mixed::find(double* values, int r, int c) const {
    const auto first = columns_.begin() + rows_[r];
    return values + (std::lower_bound(first, columns_.begin() + rows_[r + 1], c) - columns_.begin());
}

void Mixed::joint(int k, const double* z, const double* x, double* values) const {
    // Lanes: the displacements of both planks, then the joint's forces.
    using D = Dual<18>;
    const int planks[2] = {P.joints[k].i, P.joints[k].j};
    D at[2][6], r[2][6];
    for (int s = 0; s < 2; ++s)
        for (int a = 0; a < 6; ++a) at[s][a] = D::seed(x[6 * planks[s] + a], 6 * s + a), r[s][a] = D(0.0);
    V3<D> ht, hr, dt, dr;
    for (int a = 0; a < 3; ++a) ht[a] = D::seed(z[6 * k + a], 12 + a), hr[a] = D::seed(z[6 * k + 3 + a], 15 + a);
    const Place<D> pa = place_of(at[0]), pb = place_of(at[1]);
    const auto& shape = S.shape.joints[k];
    opening(pa, pb, shape.arm_i, shape.arm_j, dt, dr);
    joint_gradient(pa, pb, shape.arm_i, shape.arm_j, ht, hr, r[0], r[1]);
    for (int a = 0; a < 6; ++a) {
        const D& d = a < 3 ? dt[a] : dr[a - 3];
        for (int s = 0; s < 2; ++s) {
            double* row = find(values, 6 * k + a, at_[planks[s]]);
            for (int b = 0; b < 6; ++b) row[b] += d.d[6 * s + b] * stiffness(a);
            double* forces = find(values, at_[planks[s]] + a, 6 * k);
            for (int b = 0; b < 6; ++b) forces[b] += r[s][a].d[12 + b];
            for (int o = 0; o < 2; ++o) {
                double* own = find(values, at_[planks[s]] + a, at_[planks[o]]);
                for (int b = 0; b < 6; ++b) own[b] += r[s][a].d[6 * o + b];
            }
        }
    }
}

void Mixed::plank_terms(int load_case, Law law, const double* x, double* values) const {
    S.equilibrium.set_case(load_case);
    S.equilibrium.ground(S.shape, law, x, [&](int i, const Block& block) {
        for (int a = 0; a < 6; ++a) {
            double* row = find(values, at_[i] + a, at_[i]);
            for (int b = 0; b < 6; ++b) row[b] += block(a, b);
        }
    });
}

}  // namespace restshape::planks
