// The tests of a piece, in their order, and the state of each load case between them.
#include "furniture.hpp"

#include <limits>

#include "equilibrium.hpp"
#include "footing.hpp"
#include "joint_utilisation.hpp"
#include "overlap.hpp"
#include "shaper.hpp"

namespace restshape::planks {

Furniture::Furniture(Piece piece) : P(std::move(piece)) {
    P.find_held();
    equilibrium_ = std::make_unique<Equilibrium>(P);
    states_.resize(P.cases.size());
    for (CaseState& state : states_) state.x.assign(6 * P.count(), 0.0);
    near_.resize(states_.size() * equilibrium_->parts().size());
}

Furniture::~Furniture() = default;

int Furniture::parts() const { return static_cast<int>(equilibrium_->parts().size()); }

long Furniture::steps() const { return equilibrium_->steps(); }

void Furniture::set_shape(const double* gamma) {
    Shaper<double>(P, gamma, shape_);
    equilibrium_->find_free(shape_);
}

DesignCheck Furniture::test(const double* gamma, int wanted, bool quick) {
    DesignCheck check;
    if (hold(gamma, wanted, quick, check) && (wanted & (weak | unbalanced))) bear(check, nullptr, quick ? wanted : 0);
    return check;
}

bool Furniture::hold(const double* gamma, int wanted, bool quick, DesignCheck& check) {
    if (parts() > 1) check.flaws |= apart;
    Shaper<double>(P, gamma, shape_);
    check.faults = shape_.faults;
    if (!shape_.faults.empty()) check.flaws |= lost;
    // A shape that cannot be closed has no numbers to go on with.
    if (shape_.invalid()) {
        check = invalid(std::move(check));
        return false;
    }
    if (quick && (check.flaws & wanted)) return false;
    if (wanted & overlapping) check.overlaps = overlaps(P, shape_, quick, &separating_);
    if (!check.overlaps.empty()) check.flaws |= overlapping;
    if (quick && (check.flaws & wanted)) return false;
    stand(check, quick, quick && (wanted & unstable));
    if (quick && (check.flaws & wanted)) return false;
    equilibrium_->find_free(shape_);
    return true;
}

void Furniture::bear(DesignCheck& check, std::vector<double>* utilisations, int ending) {
    std::vector<Overloaded> most(P.joints.size(), {-1, -1, 1.0, Load::pull}), doubts = most;
    for (size_t c = 0; c < P.cases.size(); ++c) {
        equilibrate(static_cast<int>(c));
        if (!states_[c].found) check.flaws |= unbalanced, check.unbalanced.push_back(static_cast<int>(c));
        check.sprung = check.sprung || states_[c].sprung;
        add_utilisation(static_cast<int>(c), check, most, doubts, utilisations);
        if (!(check.pull <= 1.0 && check.shear <= 1.0)) check.flaws |= weak;
        if (check.flaws & ending) break;
    }
    for (const Overloaded& one : most)
        if (one.joint >= 0) check.overloaded.push_back(one);
    for (const Overloaded& one : doubts)
        if (one.joint >= 0) check.doubts.push_back(one), check.flaws |= doubtful;
}

bool Furniture::springs_rest() {
    CaseState state;
    for (size_t c = 0; c < P.cases.size(); ++c) {
        state.x.assign(6 * P.count(), 0.0);
        if (equilibrium_->solve(shape_, static_cast<int>(c), Law::bilateral, state.x) < 0 || wild(state)) return false;
    }
    return true;
}

void Furniture::set_compliance(double joint_t, double joint_r, double floor) {
    P.settings.eps_t = joint_t, P.settings.eps_r = joint_r, P.settings.eps_floor = floor;
}

int Furniture::bisect(const double* direction, double& good, double& bad, double tolerance, int wanted) {
    std::vector<double> gamma(8 * P.count());
    int tests = 0;
    for (; std::abs(bad - good) > tolerance; ++tests) {
        const double middle = 0.5 * (good + bad);
        for (size_t a = 0; a < gamma.size(); ++a) gamma[a] = middle * direction[a];
        ((test(gamma.data(), wanted, true).flaws & wanted) == 0 ? good : bad) = middle;
    }
    return tests;
}

bool Furniture::one_sided(int load_case) {
    equilibrate(load_case);
    return states_[load_case].law == Law::unilateral;
}

std::vector<double> Furniture::openings(int load_case) { return equilibrium_->openings(shape_, states_[load_case].x); }

std::vector<V3<double>> Furniture::contact_forces(int load_case) const {
    const CaseState& state = states_[load_case];
    std::vector<V3<double>> forces;
    for (const auto& contact : shape_.contacts) {
        const Place<double> a = place_of(state.x.data() + 6 * contact.plank);
        const V3<double> v = a.u + times(a.t.less_one, contact.arm);
        forces.push_back(contact_force(v, contact.normal, contact.mu, equilibrium_->floor(), state.law));
    }
    return forces;
}

double Furniture::balance(int load_case, std::vector<V3<double>>& forces) const {
    double most = 0.0;
    forces.assign(shape_.contacts.size(), {0.0, 0.0, 0.0});
    for (const Part& part : equilibrium_->parts()) {
        const Footing footing(P, shape_, part);
        const Support support = footing.support(load_case, 0.1 * balance_tolerance);
        footing.put(support, load_case, forces);
        most = std::max(most, support.unbalanced_load);
    }
    return most;
}

void Furniture::forget() {
    for (CaseState& state : states_) std::fill(state.x.begin(), state.x.end(), 0.0), state.found = false;
    for (auto& forces : near_) forces.clear();
}

void Furniture::exchange(std::vector<CaseState>& others) {
    for (size_t c = 0; c < states_.size(); ++c) {
        std::swap(states_[c].x, others[c].x), std::swap(states_[c].law, others[c].law);
        std::swap(states_[c].found, others[c].found), std::swap(states_[c].close, others[c].close);
    }
}

void Furniture::set_state(int load_case, const double* x, Law law) {
    CaseState& state = states_[load_case];
    state.x.assign(x, x + 6 * P.count());
    state.law = law, state.found = true;
}

bool Furniture::inside(int load_case) const {
    const auto forces = contact_forces(load_case);
    for (size_t k = 0; k < forces.size(); ++k) {
        const auto& contact = shape_.contacts[k];
        const double pressed = dot(forces[k], contact.normal);
        const V3<double> t = forces[k] - scaled(contact.normal, pressed);
        if (pressed < 0.0 || dot(t, t) > contact.mu * contact.mu * pressed * pressed) return false;
    }
    return true;
}

void Furniture::stand(DesignCheck& check, bool quick, bool first_only) {
    const auto& parts = equilibrium_->parts();
    std::vector<Footing> footings;
    footings.reserve(parts.size());
    for (const Part& part : parts) footings.emplace_back(P, shape_, part);
    for (size_t c = 0; c < P.cases.size(); ++c) {
        states_[c].unbalanced_load = 0.0;
        for (size_t k = 0; k < parts.size(); ++k) {
            std::vector<ConeForce>& near = near_[c * parts.size() + k];
            if (!quick) near.clear();
            Support support = footings[k].support(static_cast<int>(c), 0.1 * balance_tolerance, near);
            near = std::move(support.forces), fits_ += support.fits;
            const double left = support.unbalanced_load;
            states_[c].unbalanced_load = std::max(states_[c].unbalanced_load, left);
            if (left <= balance_tolerance) continue;
            check.falls.emplace_back(static_cast<int>(c), parts[k].planks[0]), check.flaws |= unstable;
            if (first_only) return;
        }
        check.unbalanced_load = std::max(check.unbalanced_load, states_[c].unbalanced_load);
    }
}

DesignCheck Furniture::invalid(DesignCheck check) {
    check.flaws |= lost | unstable | weak | unbalanced;
    check.pull = check.shear = check.unbalanced_load = std::numeric_limits<double>::infinity();
    return check;
}

void Furniture::equilibrate(int load_case) {
    CaseState& state = states_[load_case];
    const bool balanced = state.unbalanced_load <= balance_tolerance;
    state.sprung = false;
    if (state.found && state.law == Law::unilateral && balanced) {
        equilibrium_->look_close(state.close);
        const bool ends = equilibrium_->solve(shape_, load_case, Law::unilateral, state.x) >= 0 && !wild(state);
        equilibrium_->look_close(false);
        if (ends) return;
    }
    state.close = false;
    if (!state.found || state.law == Law::unilateral) std::fill(state.x.begin(), state.x.end(), 0.0);
    state.law = Law::bilateral;
    state.found = equilibrium_->solve(shape_, load_case, Law::bilateral, state.x) >= 0 && !wild(state);
    if (!state.found || !balanced || inside(load_case)) return;
    const std::vector<double> kept = state.x;
    bool ends = equilibrium_->solve(shape_, load_case, Law::unilateral, state.x) >= 0 && !wild(state);
    if (!ends) {
        equilibrium_->look_close(true);
        ends = stiffen(load_case) || ease(load_case, kept);
        equilibrium_->look_close(false);
        state.close = ends;
    }
    if (ends) {
        state.law = Law::unilateral;
    } else {
        state.x = kept, state.sprung = true;
    }
}

bool Furniture::stiffen(int load_case) {
    CaseState& state = states_[load_case];
    const double floor = P.settings.eps_floor;
    bool found = false;
    std::vector<double> x(6 * P.count()), bounds;
    for (const double softer : {1e3, 1e2, 1e1, 1.0}) {
        P.settings.eps_floor = softer * floor;
        // The first that converges starts from springs, the others from the last that did.
        state.x.assign(x.begin(), x.end());
        if (!found && (softer == 1.0 || equilibrium_->solve(shape_, load_case, Law::bilateral, state.x) < 0)) continue;
        bool ends = equilibrium_->solve(shape_, load_case, Law::unilateral, state.x) >= 0 && !wild(state);
        if (!ends && found) {
            state.x.assign(x.begin(), x.end());
            ends = equilibrium_->settle(shape_, load_case, bounds, state.x) && !wild(state);
        }
        if (ends) x = state.x, bounds = equilibrium_->allowed(shape_, x);
        found = softer == 1.0 ? ends : found || ends;
    }
    P.settings.eps_floor = floor;
    return found;
}

bool Furniture::ease(int load_case, const std::vector<double>& springs) {
    CaseState& state = states_[load_case];
    std::vector<V3<double>> balance;
    this->balance(load_case, balance);
    state.x = springs;
    return equilibrium_->ease(shape_, load_case, balance, state.x) && !wild(state);
}

bool Furniture::wild(const CaseState& state) const {
    for (double v : state.x)
        if (!(std::abs(v) < 0.5)) return true;
    return false;
}

void Furniture::add_utilisation(int load_case, DesignCheck& check, std::vector<Overloaded>& most,
                                std::vector<Overloaded>& doubts, std::vector<double>* utilisations) {
    const std::vector<double> d = openings(load_case);
    const auto add = [&](std::vector<Overloaded>& all, size_t k, double utilisation, Load by) {
        // A case that only repeats an earlier one, up to rounding, is not what breaks the joint.
        const double known = all[k].joint < 0 ? all[k].utilisation : all[k].utilisation * (1.0 + repeated);
        if (!(utilisation <= known)) all[k] = {static_cast<int>(k), load_case, utilisation, by};
    };
    for (size_t k = 0; k < P.joints.size(); ++k) {
        const JointSpec& spec = P.joints[k];
        const auto f = joint_force(shape_.joints[k], &d[6 * k], P.settings);
        const JointUtilisation utilisation = joint_utilisation(f, shape_.joints[k], spec, shape_.size[spec.i][2]);
        check.pull = std::max(check.pull, utilisation.pull), check.shear = std::max(check.shear, utilisation.shear);
        add(most, k, std::max(utilisation.pull, utilisation.shear),
            utilisation.shear > utilisation.pull ? Load::shear : Load::pull);
        const double moment = std::max(utilisation.line, utilisation.twist);
        const double counted = std::max(utilisation.pull, utilisation.shear);
        if (utilisations)
            (*utilisations)[k] = std::max((*utilisations)[k], P.settings.moments ? std::max(counted, moment) : counted);
        const Load by = utilisation.twist > utilisation.line ? Load::twist : Load::line;
        if (P.settings.moments) {
            check.pull = std::max(check.pull, utilisation.line), check.shear = std::max(check.shear, utilisation.twist);
            if (moment > std::max(utilisation.pull, utilisation.shear)) add(most, k, moment, by);
        } else if (by == Load::twist || !(utilisation.pull > 1.0)) {
            // What is drawn out by its tension is weak already.
            add(doubts, k, moment, by);
        }
    }
}

}  // namespace restshape::planks
