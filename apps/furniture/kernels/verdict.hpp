// Whether a piece is valid at values of its design parameters: joined, free of overlaps, stable, durable.
#pragma once

#include <limits>
#include <memory>

#include "overlap.hpp"
#include "rows.hpp"
#include "support.hpp"

namespace restshape::planks {

// What is not as it must be, as bits.
enum Flaw { lost = 1, overlapping = 2, unstable = 4, weak = 8, unbalanced = 16, apart = 32 };
constexpr int every_flaw = 63;

struct CaseState {
    std::vector<double> x;     // 6 a plank
    Law law = Law::bilateral;  // that x is an equilibrium of
    bool found = false;
    double missing = 0.0;  // the part of the load that contacts cannot balance
};

// The largest use of a joint's strength, if that is more than there is.
struct Broken {
    int joint, load_case;
    double use;
    bool sheared;
};

struct Verdict {
    int flaws = 0;
    double pull = 0.0, shear = 0.0;  // the largest use of a joint's strength, in parts of it
    double missing = 0.0;
    std::vector<Flawed> faults;
    std::vector<std::pair<int, int>> overlaps;  // as the function of that name
    std::vector<std::pair<int, int>> falls;     // case, and the first plank of the part that falls
    std::vector<int> unbalanced;                // cases
    std::vector<Broken> broken;
};

class Furniture {
 public:
    static constexpr double balance_tolerance = 1e-7;
    static constexpr double repeated = 1e-6;  // of a joint's use, that counts as the same in two cases

    explicit Furniture(Piece piece) : P(std::move(piece)) {
        P.find_held();
        parts_ = parts_of(P);
        equilibrium_ = std::make_unique<Equilibrium>(P, parts_);
        states_.resize(P.cases.size());
        for (CaseState& state : states_) state.x.assign(6 * P.count(), 0.0);
    }

    const Piece& piece() const { return P; }
    Equilibrium& equilibrium() { return *equilibrium_; }
    const Shape<double>& shape() const { return shape_; }
    const std::vector<CaseState>& states() const { return states_; }
    int parts() const { return static_cast<int>(parts_.size()); }

    // Sets the geometry to design parameters (8 a plank), or to the piece as it is.
    void set_shape(const double* gamma) {
        Shaper<double>(P, gamma, shape_);
        equilibrium_->find_free(shape_);
    }

    // Tests at design parameters; with `quick` it ends at the first flaw among those `wanted`.
    Verdict test(const double* gamma, int wanted, bool quick) {
        Verdict verdict;
        if (parts_.size() > 1) verdict.flaws |= apart;
        Shaper<double>(P, gamma, shape_);
        verdict.faults = shape_.faults;
        if (!shape_.faults.empty()) verdict.flaws |= lost;
        // A shape that cannot be closed has no numbers to go on with.
        if (shape_.spoilt()) return spoilt(verdict);
        if (quick && (verdict.flaws & wanted)) return verdict;
        if (wanted & overlapping) verdict.overlaps = overlaps(P, shape_, quick);
        if (!verdict.overlaps.empty()) verdict.flaws |= overlapping;
        if (quick && (verdict.flaws & wanted)) return verdict;
        stand(verdict);
        if (!(wanted & (weak | unbalanced)) || (quick && (verdict.flaws & wanted))) return verdict;
        equilibrium_->find_free(shape_);
        std::vector<Broken> most(P.joints.size(), {-1, -1, 1.0, false});
        for (size_t c = 0; c < P.cases.size(); ++c) {
            settle(static_cast<int>(c));
            if (!states_[c].found) verdict.flaws |= unbalanced, verdict.unbalanced.push_back(static_cast<int>(c));
            use(static_cast<int>(c), verdict, most);
        }
        for (const Broken& one : most)
            if (one.joint >= 0) verdict.broken.push_back(one);
        if (!(verdict.pull <= 1.0 && verdict.shear <= 1.0)) verdict.flaws |= weak;
        return verdict;
    }

    // Narrows a bracket of a parameter t along a direction (8 a plank), of whose ends one is free of what is wanted
    // away, until it is within a tolerance; gives the number of tests.
    int bisect(const double* direction, double& good, double& bad, double tolerance, int wanted) {
        std::vector<double> gamma(8 * P.count());
        int tests = 0;
        for (; std::abs(bad - good) > tolerance; ++tests) {
            const double middle = 0.5 * (good + bad);
            for (size_t a = 0; a < gamma.size(); ++a) gamma[a] = middle * direction[a];
            ((test(gamma.data(), wanted, true).flaws & wanted) == 0 ? good : bad) = middle;
        }
        return tests;
    }

    // Brings a case to equilibrium, from the state that it has; returns whether with one-sided contacts.
    bool one_sided(int load_case) {
        settle(load_case);
        return states_[load_case].law == Law::unilateral;
    }

    // Openings (6 a joint) at the state of a case.
    std::vector<double> openings(int load_case) {
        std::vector<double> d(6 * P.joints.size()), r(6 * P.count());
        const CaseState& state = states_[load_case];
        equilibrium_->gradient(shape_, load_case, state.law, state.x.data(), r.data(), d.data());
        return d;
    }

    // Forces (3 each) of the contacts on their planks at the state of a case.
    std::vector<V3<double>> contact_forces(int load_case) const {
        const CaseState& state = states_[load_case];
        std::vector<V3<double>> forces;
        for (const auto& contact : shape_.contacts) {
            const Place<double> a = place_of(state.x.data() + 6 * contact.plank);
            const V3<double> v = a.u + times(a.t.less_one, contact.arm);
            forces.push_back(contact_force(v, contact.normal, contact.mu, equilibrium_->floor(), state.law));
        }
        return forces;
    }

    // Balances the loads of a case by forces inside the friction cones; fills them in where asked for.
    double missing(int load_case, std::vector<V3<double>>* forces = nullptr) const {
        double most = 0.0;
        if (forces) forces->assign(shape_.contacts.size(), {0.0, 0.0, 0.0});
        for (const Part& part : parts_) most = std::max(most, missing(part, load_case, forces));
        return most;
    }

    void forget() {
        for (CaseState& state : states_) std::fill(state.x.begin(), state.x.end(), 0.0), state.found = false;
    }

    // Sets the state of a case from elsewhere.
    void set_state(int load_case, const double* x, Law law) {
        CaseState& state = states_[load_case];
        state.x.assign(x, x + 6 * P.count());
        state.law = law, state.found = true;
    }

    // Whether no contact of the springs pulls, or pushes sideways beyond its friction.
    bool inside(int load_case) const {
        const auto forces = contact_forces(load_case);
        for (size_t k = 0; k < forces.size(); ++k) {
            const auto& contact = shape_.contacts[k];
            const double pressed = dot(forces[k], contact.normal);
            const V3<double> t = forces[k] - scaled(contact.normal, pressed);
            if (pressed < 0.0 || dot(t, t) > contact.mu * contact.mu * pressed * pressed) return false;
        }
        return true;
    }

 private:
    Piece P;
    std::vector<Part> parts_;
    std::unique_ptr<Equilibrium> equilibrium_;
    Shape<double> shape_;
    std::vector<CaseState> states_;

    // Which loads the contacts of each part cannot balance.
    void stand(Verdict& verdict) {
        for (size_t c = 0; c < P.cases.size(); ++c) {
            states_[c].missing = 0.0;
            for (const Part& part : parts_) {
                const double left = missing(part, static_cast<int>(c), nullptr);
                states_[c].missing = std::max(states_[c].missing, left);
                if (!(left <= balance_tolerance)) verdict.falls.emplace_back(static_cast<int>(c), part.planks[0]);
            }
            verdict.missing = std::max(verdict.missing, states_[c].missing);
        }
        if (!verdict.falls.empty()) verdict.flaws |= unstable;
    }

    static Verdict spoilt(Verdict verdict) {
        verdict.flaws |= lost | unstable | weak | unbalanced;
        verdict.pull = verdict.shear = verdict.missing = std::numeric_limits<double>::infinity();
        return verdict;
    }

    // One-sided contact from the last such state where there is one; else springs, and one-sided contact where those
    // pull or slide.
    void settle(int load_case) {
        CaseState& state = states_[load_case];
        const bool balanced = state.missing <= balance_tolerance;
        if (state.found && state.law == Law::unilateral && balanced &&
            equilibrium_->solve(shape_, load_case, Law::unilateral, state.x) >= 0 && !wild(state))
            return;
        if (!state.found || state.law == Law::unilateral) std::fill(state.x.begin(), state.x.end(), 0.0);
        state.law = Law::bilateral;
        state.found = equilibrium_->solve(shape_, load_case, Law::bilateral, state.x) >= 0 && !wild(state);
        if (!state.found || !balanced || inside(load_case)) return;
        const std::vector<double> kept = state.x;
        const bool ends = equilibrium_->solve(shape_, load_case, Law::unilateral, state.x) >= 0 && !wild(state);
        if (ends || ease(load_case, kept)) {
            state.law = Law::unilateral;
        } else {
            state.x = kept;
        }
    }

    // Whether one-sided contacts converge by the longer way, from where springs are.
    bool ease(int load_case, const std::vector<double>& springs) {
        CaseState& state = states_[load_case];
        std::vector<V3<double>> balance;
        missing(load_case, &balance);
        state.x = springs;
        return equilibrium_->ease(shape_, load_case, balance, state.x) && !wild(state);
    }

    bool wild(const CaseState& state) const {
        for (double v : state.x)
            if (!(std::abs(v) < 0.5)) return true;
        return false;
    }

    void use(int load_case, Verdict& verdict, std::vector<Broken>& most) {
        const std::vector<double> d = openings(load_case);
        for (size_t k = 0; k < P.joints.size(); ++k) {
            const auto f = joint_force(shape_.joints[k], &d[6 * k], P.settings);
            const JointSpec& spec = P.joints[k];
            const double nails = shape_.joints[k].nails, lever = shape_.size[spec.i][2];
            const double pull = (2.0 * std::abs(f.bending) / lever + f.tension) / nails / spec.pull;
            const double shear = std::hypot(f.shear_x, f.shear_y) / nails / spec.shear;
            verdict.pull = std::max(verdict.pull, pull), verdict.shear = std::max(verdict.shear, shear);
            // A case that only repeats an earlier one, up to rounding, is not what breaks the joint.
            const double known = most[k].joint < 0 ? most[k].use : most[k].use * (1.0 + repeated);
            if (!(std::max(pull, shear) <= known))
                most[k] = {static_cast<int>(k), load_case, std::max(pull, shear), shear > pull};
        }
    }

    double missing(const Part& part, int load_case, std::vector<V3<double>>* forces) const {
        std::vector<V3<double>> points, normals;
        std::vector<double> mu;
        std::vector<size_t> index;
        std::vector<char> mine(P.count(), 0);
        for (int i : part.planks) mine[i] = 1;
        for (size_t k = 0; k < shape_.contacts.size(); ++k) {
            const auto& contact = shape_.contacts[k];
            if (!mine[contact.plank]) continue;
            points.push_back(contact.point), normals.push_back(contact.normal), mu.push_back(contact.mu);
            index.push_back(k);
        }
        if (points.empty()) return 1.0;
        V3<double> middle{0.0, 0.0, 0.0};
        for (const auto& p : points) middle = middle + scaled(p, 1.0 / points.size());
        double reach = 1e-9;
        for (auto& p : points) p = p - middle, reach = std::max(reach, std::sqrt(dot(p, p)));
        for (auto& p : points) p = scaled(p, 1.0 / reach);
        V3<double> force{0.0, 0.0, 0.0}, moment = force;
        double weight = 0.0;
        const auto add = [&](const V3<double>& at, const V3<double>& f) {
            force = force - f, moment = moment - cross(scaled(at - middle, 1.0 / reach), f);
            weight += std::sqrt(dot(f, f));
        };
        for (int i : part.planks) add(shape_.centre[i], scaled(P.gravity, shape_.mass[i]));
        for (size_t k = 0; k < P.loads.size(); ++k)
            if (const int i = P.loads[k].plank; mine[i])
                add(shape_.centre[i] + shape_.load_arms[k], P.cases[load_case][k]);
        if (weight == 0.0) return 0.0;
        Wrench load;
        load << force[0], force[1], force[2], moment[0], moment[1], moment[2];
        const Support support = ConeProjection(points, normals, mu, load / weight).solve(0.1 * balance_tolerance);
        for (size_t k = 0; forces && k < index.size(); ++k) (*forces)[index[k]] = scaled(support.forces[k], weight);
        return support.missing;
    }
};

}  // namespace restshape::planks
