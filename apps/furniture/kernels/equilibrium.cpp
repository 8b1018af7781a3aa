// Newton's method for the equilibrium of a piece, and its stiffness block by block.
#include "equilibrium.hpp"

#include <Eigen/Cholesky>
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

// How a point at the end of an arm goes with the rotation vector of its plank.
Eigen::Matrix3d swing(const Place<double>& at, const V3<double>& arm) {
    const V3<double> now = turned(at.t, arm);
    Eigen::Matrix3d ways;
    for (int c = 0; c < 3; ++c) {
        const V3<double> way = cross(column(at.t.rate, c), now);
        ways.col(c) << way[0], way[1], way[2];
    }
    return ways;
}

// What a force at the end of an arm adds to the stiffness of its plank's rotation: the second derivative of
// -force . (w x (w x arm)) / 2.
Eigen::Matrix3d turning(const V3<double>& arm, const V3<double>& force) {
    Eigen::Matrix3d stiffness = Eigen::Matrix3d::Identity() * dot(force, arm);
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) stiffness(r, c) -= 0.5 * (force[r] * arm[c] + arm[r] * force[c]);
    return stiffness;
}

// Sums over the contacts of a part that stick: whether they hold it in all ways is so found from a few numbers.
struct Sticking {
    double count = 0.0, reach2 = 0.0;
    V3<double> sum{0.0, 0.0, 0.0};
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();

    void add(const V3<double>& arm, bool sticks) {
        reach2 = std::max(reach2, dot(arm, arm));
        if (!sticks) return;
        const Eigen::Vector3d a(arm.data());
        count += 1.0, sum = sum + arm;
        products += a * a.transpose();
    }

    // Whether the inertia of unit masses at the contacts about their middle is positive by far. By Schur's complement
    // the stiffness of all motions is then positive, too; other contacts only add to it.
    bool hold() const {
        if (count < 3.0) return false;
        const Eigen::Vector3d middle = Eigen::Vector3d(sum.data()) / count;
        const Eigen::Matrix3d about = products - count * middle * middle.transpose();
        const double all = about.trace(), least = well_held * count * reach2;
        return Eigen::LLT<Eigen::Matrix3d>((all - least) * Eigen::Matrix3d::Identity() - about).info() ==
               Eigen::Success;
    }

    static constexpr double well_held = 1e-4;
};

// Whether two residuals are equal but for rounding.
bool same(double one, double other) { return std::abs(one - other) <= 1e-12 * other; }

// Of a residual, in parts of the loads, of a law that is only on the way.
constexpr double rough = 1e-5;
// The same under Coulomb's law, from which on friction with bounds may lead to it.
constexpr double near = 1e-3;
// How often pressures give friction its bounds.
constexpr int most_rounds = 6;
// Newton's steps under Coulomb's law in which the residual may fail to fall to half its least so far.
constexpr int most_vain = 5;

}  // namespace

Equilibrium::Equilibrium(const Piece& piece) : P(piece), parts_(parts_of(piece)), plank_part_(piece.count()) {
    std::vector<std::pair<int, int>> pairs;
    for (const JointSpec& joint : P.joints) pairs.emplace_back(joint.i, joint.j);
    blocks_ = Blocks(P.count(), pairs);
    for (size_t k = 0; k < parts_.size(); ++k)
        for (int i : parts_[k].planks) plank_part_[i] = static_cast<int>(k);
}

void Equilibrium::find_free(const Shape<double>& shape) {
    std::vector<Sticking> sticking(parts_.size());
    for (const auto& contact : shape.contacts) {
        const int k = plank_part_[contact.plank];
        sticking[k].add(contact.point - shape.centre[parts_[k].carrier], contact.mu > 0.0);
    }
    for (size_t k = 0; k < parts_.size(); ++k) {
        parts_[k].free.clear();
        if (!sticking[k].hold()) find_free(shape, static_cast<int>(k));
    }
}

void Equilibrium::find_free(const Shape<double>& shape, int part) {
    Block ground = Block::Zero();
    double reach = 0.0;
    for (const auto& contact : shape.contacts) {
        if (plank_part_[contact.plank] != part) continue;
        const V3<double> arm = contact.point - shape.centre[parts_[part].carrier];
        reach = std::max(reach, std::sqrt(dot(arm, arm)));
        Eigen::Matrix<double, 3, 6> way;
        way << Eigen::Matrix3d::Identity(), -spin(arm);
        const Eigen::Vector3d n(contact.normal.data());
        Eigen::Matrix3d held = n * n.transpose();
        if (contact.mu > 0.0) held.setIdentity();
        ground += way.transpose() * held * way;
    }
    parts_[part].free = free_motions(ground, reach);
}

std::vector<double> Equilibrium::openings(const Shape<double>& shape, const std::vector<double>& x) {
    place(x.data());
    std::vector<double> d;
    d.reserve(6 * P.joints.size());
    for (size_t k = 0; k < P.joints.size(); ++k) {
        V3<double> dt, dr;
        opening(places_[P.joints[k].i], places_[P.joints[k].j], shape.joints[k].arm_i, shape.joints[k].arm_j, dt, dr);
        d.insert(d.end(), dt.begin(), dt.end()), d.insert(d.end(), dr.begin(), dr.end());
    }
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
    if (turned_) {
        blocks_.clear();
        place(x);
        for (size_t k = 0; k < P.joints.size(); ++k) turned_joint(shape, k);
        for (size_t k = 0; k < P.loads.size(); ++k)
            if (const int i = P.loads[k].plank; carried(i)) {
                const V3<double> arm = turned(places_[i].t, shape.load_arms[k]);
                blocks_.at(i, i).bottomRightCorner<3, 3>() += turning(arm, P.cases[load_case_][k]);
            }
    } else if (joints_known && !exact) {
        blocks_.restore();
    } else {
        blocks_.clear();
        for (size_t k = 0; k < P.joints.size(); ++k) exact ? exact_joint(shape, k, x) : small_joint(shape, k);
        if (!exact) blocks_.keep();
    }
    add_ground(shape, law, x, exact, [this](int i, const Block& block) { blocks_.at(i, i) += block; });
    for (int i = 0; i < P.count(); ++i) blocks_.at(i, i).diagonal().array() += P.settings.shift * joint_t();
}

int Equilibrium::solve(const Shape<double>& shape, int load_case, Law law, std::vector<double>& x, double from) {
    const int n = 6 * P.count();
    load_case_ = load_case;
    double scale = 0.0;
    for (int i = 0; i < P.count(); ++i) scale += shape.mass[i] * std::abs(P.gravity[2]);
    for (const auto& f : P.cases[load_case]) scale += std::sqrt(dot(f, f));
    std::vector<double> r(n), slope;
    double best = 1e300, last = 1e300, before[4] = {1e300, 1e300, 1e300, 1e300};
    bool exact = false, fresh = false;
    int best_step = 0;
    const int most = law == Law::bilateral ? 25 : 40;
    for (int step = 0; step < most; ++step) {
        gradient(shape, load_case, law, x.data(), r.data());
        double norm = 0.0;
        for (double v : r) norm = std::max(norm, std::abs(v));
        if (!(norm < 1e15) || (step == 0 && norm > from * scale)) return -1;
        if (norm <= (law == Law::bounded ? rough : 1e-11) * scale) return step;
        // A residual that stays small is rounding.
        if (norm <= 1e-8 * scale && norm > 0.5 * last) return step;
        // Contacts that come and go in turns do so for ever.
        if (law == Law::unilateral && same(norm, before[1]) && same(before[0], before[2]) && same(norm, before[3]))
            return -1;
        if (norm < 0.5 * best) best = norm, best_step = step;
        if (law == Law::unilateral && step > best_step + most_vain) return -1;
        std::copy_backward(before, before + 3, before + 4), before[0] = norm;
        if (turned_ || !fresh || norm > 0.1 * last) {
            exact = exact || (law == Law::bilateral && fresh && !turned_);
            stiffness(shape, law, x.data(), exact, fresh);
            blocks_.factor();
            fresh = true;
        }
        if (law == Law::bounded) slope = r;
        blocks_.solve(r);
        ++steps_;
        if (law == Law::bounded) {
            search(shape, slope, r, x);
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
    std::vector<double> balanced, stuck = x;
    for (size_t k = 0; k < balance.size(); ++k)
        balanced.push_back(shape.contacts[k].mu * std::max(dot(shape.contacts[k].normal, balance[k]), 0.0));
    if (settle(shape, load_case, allowed(shape, x), x)) return true;
    x = stuck;
    return settle(shape, load_case, std::move(balanced), x);
}

bool Equilibrium::settle(const Shape<double>& shape, int load_case, std::vector<double> bounds,
                         std::vector<double>& x) {
    bounds_ = std::move(bounds);
    for (int round = 0; round < most_rounds; ++round) {
        if (solve(shape, load_case, Law::bounded, x) < 0) return false;
        bounds_ = allowed(shape, x);
        std::vector<double> slides = x;
        if (solve(shape, load_case, Law::unilateral, slides, round + 1 < most_rounds ? near : 1e300) < 0) continue;
        x = slides;
        return true;
    }
    return false;
}

void Equilibrium::place(const double* x) {
    places_.resize(P.count());
    for (int i = 0; i < P.count(); ++i) places_[i] = place_of(x + 6 * i);
}

std::vector<double> Equilibrium::allowed(const Shape<double>& shape, const std::vector<double>& x) {
    place(x.data());
    std::vector<double> most;
    for (const auto& contact : shape.contacts) {
        const Place<double>& at = places_[contact.plank];
        const V3<double> v = at.u + times(at.t.less_one, contact.arm);
        most.push_back(contact.mu * std::max(-floor() * dot(v, contact.normal), 0.0));
    }
    return most;
}

void Equilibrium::search(const Shape<double>& shape, const std::vector<double>& slope, const std::vector<double>& step,
                         std::vector<double>& x) {
    place(x.data());
    std::vector<V3<double>> at, way;
    for (const auto& contact : shape.contacts) {
        const double* dx = step.data() + 6 * contact.plank;
        const Place<double>& now = places_[contact.plank];
        at.push_back(now.u + times(now.t.less_one, contact.arm));
        way.push_back(V3<double>{dx[0], dx[1], dx[2]} + cross(V3<double>{dx[3], dx[4], dx[5]}, contact.arm));
    }
    const auto contacts = [&](double t) {
        double sum = 0.0;
        for (size_t k = 0; k < at.size(); ++k) {
            const auto& contact = shape.contacts[k];
            const V3<double> v = at[k] - scaled(way[k], t);
            sum -= dot(contact_force(v, contact.normal, contact.mu, floor(), Law::bounded, bounds_[k]), way[k]);
        }
        return sum;
    };
    // Joints and free motions have a slope that is linear along the step.
    const double first = std::inner_product(step.begin(), step.end(), slope.begin(), 0.0);
    const double linear = first - contacts(0.0), bend = linear_curvature(shape, step);
    double low = 0.0, high = 0.0, at_low = first, at_high = 0.0, t = 1.0;
    for (int k = 0; k < 60; ++k) {
        const double now = linear - t * bend + contacts(t);
        if (!(std::abs(now) > 0.01 * std::abs(first))) break;
        (now > 0.0 ? low : high) = t, (now > 0.0 ? at_low : at_high) = now;
        // Secants, and halves in turns: slopes have kinks.
        const double part = k % 2 ? 0.5 : at_low / (at_low - at_high);
        t = high == 0.0 ? 2.0 * t : low + part * (high - low);
    }
    for (size_t a = 0; a < x.size(); ++a) x[a] -= t * step[a];
}

double Equilibrium::linear_curvature(const Shape<double>& shape, const std::vector<double>& step) const {
    const auto part = [&](int plank, int first) {
        const double* dx = step.data() + 6 * plank + first;
        return V3<double>{dx[0], dx[1], dx[2]};
    };
    double sum = 0.0;
    for (size_t k = 0; k < P.joints.size(); ++k) {
        const int i = P.joints[k].i, j = P.joints[k].j;
        const V3<double> wi = part(i, 3), wj = part(j, 3), dr = wi - wj;
        const V3<double> dt =
            part(i, 0) + cross(wi, shape.joints[k].arm_i) - part(j, 0) - cross(wj, shape.joints[k].arm_j);
        sum += joint_t() * dot(dt, dt) + joint_r() * dot(dr, dr);
    }
    for (const Part& one : parts_)
        for (const auto& q : one.free) {
            double along = 0.0;
            for (int a = 0; a < 6; ++a) along += step[6 * one.carrier + a] * q[a];
            sum += floor() * along * along;
        }
    return sum;
}

void Equilibrium::small_joint(const Shape<double>& shape, size_t k) {
    put_joint(P.joints[k].i, P.joints[k].j, -spin(shape.joints[k].arm_i), -spin(shape.joints[k].arm_j));
}

void Equilibrium::put_joint(int i, int j, const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
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

void Equilibrium::turned_joint(const Shape<double>& shape, size_t k) {
    const int i = P.joints[k].i, j = P.joints[k].j;
    const JointShape<double>& joint = shape.joints[k];
    const Place<double>&pi = places_[i], &pj = places_[j];
    const V3<double> dt = pi.u + times(pi.t.less_one, joint.arm_i) - pj.u - times(pj.t.less_one, joint.arm_j);
    put_joint(i, j, swing(pi, joint.arm_i), swing(pj, joint.arm_j));
    const V3<double> pull = scaled(dt, -joint_t());
    blocks_.at(i, i).bottomRightCorner<3, 3>() += turning(turned(pi.t, joint.arm_i), pull);
    blocks_.at(j, j).bottomRightCorner<3, 3>() -= turning(turned(pj.t, joint.arm_j), pull);
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

Block Equilibrium::turned_contact(const Contact<double>& contact, Law law, double bound) const {
    const Place<double>& at = places_[contact.plank];
    const V3<double> v = at.u + times(at.t.less_one, contact.arm);
    const M3<double> k = contact_stiffness(v, contact.normal, contact.mu, floor(), law, bound);
    const V3<double> force = contact_force(v, contact.normal, contact.mu, floor(), law, bound);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> stiff(k.data());
    Eigen::Matrix<double, 3, 6> way;
    way << Eigen::Matrix3d::Identity(), swing(at, contact.arm);
    Block block = way.transpose() * stiff * way;
    block.bottomRightCorner<3, 3>() += turning(turned(at.t, contact.arm), force);
    return block;
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
