// Newton's method for the equilibrium of a piece, and its stiffness block by block.
#include "equilibrium.hpp"

#include <limits>
#include <numeric>

#include "gradient.hpp"

namespace restshape::planks {

inline Eigen::Matrix3d spin(const V3<double>& a) {
    Eigen::Matrix3d m;
    m << 0.0, -a[2], a[1], a[2], 0.0, -a[0], -a[1], a[0], 0.0;
    return m;
}

namespace {

// Whether two residuals are equal but for rounding.
bool same(double one, double other) { return std::abs(one - other) <= 1e-12 * other; }

}  // namespace

Equilibrium::Equilibrium(const Piece& piece) : P(piece), parts_(parts_of(piece)), plank_part_(piece.count()) {
    std::vector<std::pair<int, int>> pairs;
    for (const JointSpec& joint : P.joints) pairs.emplace_back(joint.i, joint.j);
    blocks_ = Blocks(P.count(), pairs);
    for (size_t k = 0; k < parts_.size(); ++k)
        for (int i : parts_[k].planks) plank_part_[i] = static_cast<int>(k);
}

void Equilibrium::find_free(const Shape<double>& shape) {
    std::vector<Block> ground(parts_.size(), Block::Zero());
    std::vector<double> reach(parts_.size(), 0.0);
    for (const auto& contact : shape.contacts) {
        const int k = plank_part_[contact.plank];
        const V3<double> arm = contact.point - shape.centre[parts_[k].carrier];
        reach[k] = std::max(reach[k], std::sqrt(dot(arm, arm)));
        Eigen::Matrix<double, 3, 6> way;
        way << Eigen::Matrix3d::Identity(), -spin(arm);
        const Eigen::Vector3d n(contact.normal.data());
        Eigen::Matrix3d held = n * n.transpose();
        if (contact.mu > 0.0) held.setIdentity();
        ground[k] += way.transpose() * held * way;
    }
    for (size_t k = 0; k < parts_.size(); ++k) parts_[k].free = free_motions(ground[k], reach[k]);
}

std::vector<double> Equilibrium::openings(const Shape<double>& shape, int load_case, Law law,
                                          const std::vector<double>& x) const {
    std::vector<double> d(6 * P.joints.size()), r(6 * P.count());
    gradient(shape, load_case, law, x.data(), r.data(), d.data());
    return d;
}

double Equilibrium::energy(const Shape<double>& shape, int load_case, const double* x,
                           const double* joint_forces) const {
    const int n = P.count();
    std::vector<Place<double>> at(n);
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        at[i] = place_of(x + 6 * i);
        if (carried(i)) sum -= shape.mass[i] * dot(at[i].u, P.gravity);
    }
    for (size_t k = 0; k < P.joints.size(); ++k) {
        V3<double> dt, dr;
        opening(at[P.joints[k].i], at[P.joints[k].j], shape.joints[k].arm_i, shape.joints[k].arm_j, dt, dr);
        const double* h = joint_forces + 6 * k;
        for (int a = 0; a < 3; ++a)
            sum +=
                h[a] * (dt[a] - 0.5 * P.settings.eps_t * h[a]) + h[3 + a] * (dr[a] - 0.5 * P.settings.eps_r * h[3 + a]);
    }
    for (const auto& contact : shape.contacts) {
        const Place<double>& a = at[contact.plank];
        const V3<double> v = a.u + times(a.t.less_one, contact.arm);
        const double pen = dot(v, contact.normal);
        sum += 0.5 * floor() * (contact.mu == 0.0 ? pen * pen : dot(v, v));
    }
    for (size_t k = 0; k < P.loads.size(); ++k)
        if (const Place<double>& a = at[P.loads[k].plank]; carried(P.loads[k].plank))
            sum -= dot(a.u + times(a.t.less_one, shape.load_arms[k]), P.cases[load_case][k]);
    for (const Part& part : parts_)
        for (const auto& q : part.free) {
            double along = 0.0;
            for (int a = 0; a < 6; ++a) along += x[6 * part.carrier + a] * q[a];
            sum += 0.5 * floor() * along * along;
        }
    return sum;
}

void Equilibrium::stiffness(const Shape<double>& shape, Law law, const double* x, bool exact, bool joints_known) {
    if (joints_known && !exact) {
        blocks_.restore();
    } else {
        blocks_.clear();
        for (size_t k = 0; k < P.joints.size(); ++k) exact ? exact_joint(shape, k, x) : small_joint(shape, k);
        if (!exact) blocks_.keep();
    }
    add_ground(shape, law, x, exact, [this](int i, const Block& block) { blocks_.at(i, i) += block; });
    for (int i = 0; i < P.count(); ++i) blocks_.at(i, i).diagonal().array() += P.settings.shift * joint_t();
}

int Equilibrium::solve(const Shape<double>& shape, int load_case, Law law, std::vector<double>& x) {
    const int n = 6 * P.count();
    load_case_ = load_case;
    double scale = 0.0;
    for (int i = 0; i < P.count(); ++i) scale += shape.mass[i] * std::abs(P.gravity[2]);
    for (const auto& f : P.cases[load_case]) scale += std::sqrt(dot(f, f));
    std::vector<double> r(n), slope;
    double last = 1e300, before[4] = {1e300, 1e300, 1e300, 1e300};
    bool exact = false, fresh = false;
    const int most = law == Law::bilateral ? 25 : 40;
    for (int step = 0; step < most; ++step) {
        gradient(shape, load_case, law, x.data(), r.data());
        double norm = 0.0;
        for (double v : r) norm = std::max(norm, std::abs(v));
        if (!(norm < 1e15)) return -1;
        if (norm <= 1e-11 * scale) return step;
        // A residual that stays small is rounding.
        if (norm <= 1e-8 * scale && norm > 0.5 * last) return step;
        // Contacts that come and go in turns do so for ever.
        if (law == Law::unilateral && same(norm, before[1]) && same(before[0], before[2]) && same(norm, before[3]))
            return -1;
        std::copy_backward(before, before + 3, before + 4), before[0] = norm;
        if (!fresh || norm > 0.1 * last) {
            exact = exact || (law == Law::bilateral && fresh);
            stiffness(shape, law, x.data(), exact, fresh);
            blocks_.factor();
            fresh = true;
        }
        if (law == Law::bounded) slope = r;
        blocks_.solve(r);
        if (law == Law::bounded) {
            search(shape, load_case, slope, r, x);
        } else {
            for (int k = 0; k < n; ++k) x[k] -= r[k];
        }
        last = norm;
    }
    return -1;
}

bool Equilibrium::ease(const Shape<double>& shape, int load_case, const std::vector<V3<double>>& balance,
                       std::vector<double>& x) {
    bounds_.assign(shape.contacts.size(), std::numeric_limits<double>::infinity());
    if (solve(shape, load_case, Law::bounded, x) < 0) return false;
    const std::vector<double> stuck = x;
    for (const bool balanced : {false, true}) {
        x = stuck;
        for (size_t k = 0; k < bounds_.size(); ++k) {
            const auto& contact = shape.contacts[k];
            const Place<double> at = place_of(x.data() + 6 * contact.plank);
            const V3<double> v = at.u + times(at.t.less_one, contact.arm);
            const double pressed = dot(contact.normal, balanced ? balance[k] : scaled(v, -floor()));
            bounds_[k] = contact.mu * std::max(pressed, 0.0);
        }
        if (solve(shape, load_case, Law::bounded, x) >= 0 && solve(shape, load_case, Law::unilateral, x) >= 0)
            return true;
    }
    return false;
}

void Equilibrium::search(const Shape<double>& shape, int load_case, const std::vector<double>& slope,
                         const std::vector<double>& step, std::vector<double>& x) {
    const auto along = [&step](const std::vector<double>& g) {
        return std::inner_product(step.begin(), step.end(), g.begin(), 0.0);
    };
    const double first = along(slope);
    std::vector<double> at(x.size()), r(x.size());
    double low = 0.0, high = 0.0, t = 1.0;
    for (int k = 0; k < 30; ++k) {
        for (size_t a = 0; a < x.size(); ++a) at[a] = x[a] - t * step[a];
        gradient(shape, load_case, Law::bounded, at.data(), r.data());
        const double now = along(r);
        if (!(std::abs(now) > 0.1 * std::abs(first))) break;
        (now > 0.0 ? low : high) = t;
        t = high == 0.0 ? 2.0 * t : 0.5 * (low + high);
    }
    x = at;
}

void Equilibrium::small_joint(const Shape<double>& shape, size_t k) {
    const int i = P.joints[k].i, j = P.joints[k].j;
    const Eigen::Matrix3d a = -spin(shape.joints[k].arm_i), b = -spin(shape.joints[k].arm_j);
    const auto put = [this](int r, int c, const Eigen::Matrix3d& left, const Eigen::Matrix3d& right, double sign) {
        Block& block = blocks_.at(r, c);
        block.topLeftCorner<3, 3>().diagonal().array() += sign * joint_t();
        block.topRightCorner<3, 3>() += sign * joint_t() * right;
        block.bottomLeftCorner<3, 3>() += sign * joint_t() * left.transpose();
        block.bottomRightCorner<3, 3>() += sign * joint_t() * left.transpose() * right;
        block.bottomRightCorner<3, 3>().diagonal().array() += sign * joint_r();
    };
    put(i, i, a, a, 1.0), put(j, j, b, b, 1.0), put(i, j, a, b, -1.0), put(j, i, b, a, -1.0);
}

void Equilibrium::exact_joint(const Shape<double>& shape, size_t k, const double* x) {
    using D = Dual<12>;
    const int i = P.joints[k].i, j = P.joints[k].j;
    D xi[6], xj[6], ri[6], rj[6];
    for (int a = 0; a < 6; ++a) {
        xi[a] = D::seed(x[6 * i + a], a), xj[a] = D::seed(x[6 * j + a], 6 + a);
        ri[a] = rj[a] = D(0.0);
    }
    const Place<D> pi = place_of(xi), pj = place_of(xj);
    V3<D> dt, dr;
    const JointShape<double>& joint = shape.joints[k];
    opening(pi, pj, joint.arm_i, joint.arm_j, dt, dr);
    joint_gradient(pi, pj, joint.arm_i, joint.arm_j, scaled(dt, joint_t()), scaled(dr, joint_r()), ri, rj);
    for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b) {
            blocks_.at(i, i)(a, b) += ri[a].d[b], blocks_.at(i, j)(a, b) += ri[a].d[6 + b];
            blocks_.at(j, i)(a, b) += rj[a].d[b], blocks_.at(j, j)(a, b) += rj[a].d[6 + b];
        }
}

// Not inlined: GCC 12 on AVX-512 would warn of derivatives used uninitialised, which they are not.
[[gnu::noinline]] Block Equilibrium::block_of(const Dual<6> (&r)[6]) {
    Block block;
    for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b) block(a, b) = r[a].d[b];
    return block;
}

Block Equilibrium::exact_contact(const Contact<double>& contact, Law law, const double* x, double bound) const {
    using D = Dual<6>;
    D at[6], r[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int a = 0; a < 6; ++a) at[a] = D::seed(x[a], a);
    const Place<D> place = place_of(at);
    const V3<D> v = place.u + times(place.t.less_one, contact.arm);
    force_gradient(place, contact.arm, contact_force(v, contact.normal, contact.mu, floor(), law, bound), r);
    return block_of(r);
}

Block Equilibrium::small_contact(const Contact<double>& contact, Law law, const double* x, double bound) const {
    const V3<double> v = V3<double>{x[0], x[1], x[2]} + cross(V3<double>{x[3], x[4], x[5]}, contact.arm);
    const M3<double> k = contact_stiffness(v, contact.normal, contact.mu, floor(), law, bound);
    Block block;
    // A turn w displaces the point by w x arm, and a force there has the moment arm x force.
    const auto put = [&](int c, const V3<double>& force) {
        const V3<double> moment = cross(contact.arm, force);
        for (int a = 0; a < 3; ++a) block(a, c) = force[a], block(3 + a, c) = moment[a];
    };
    V3<double> rows[3];
    for (int a = 0; a < 3; ++a) rows[a] = cross(contact.arm, V3<double>{k[3 * a], k[3 * a + 1], k[3 * a + 2]});
    for (int c = 0; c < 3; ++c) put(c, column(k, c)), put(3 + c, {rows[0][c], rows[1][c], rows[2][c]});
    return block;
}

Block Equilibrium::load_stiffness(const Shape<double>& shape, size_t k, const double* x) const {
    using D = Dual<6>;
    D at[6], r[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int a = 0; a < 6; ++a) at[a] = D::seed(x[a], a);
    force_gradient(place_of(at), shape.load_arms[k], P.cases[load_case_][k], r);
    return block_of(r);
}

}  // namespace restshape::planks
