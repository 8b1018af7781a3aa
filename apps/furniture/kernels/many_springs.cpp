// The tests of a piece with many springs: what no compliance changes is tested once.
#include "many_springs.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace restshape::planks {

namespace {

// The utilisations of joints over some springs, and whether the piece bears its loads with them.
struct Spread {
    std::vector<double> low, high;
    bool bears = false, breaks = false;

    explicit Spread(int joints) : low(joints, std::numeric_limits<double>::infinity()), high(joints, 0.0) {}

    void add(const DesignCheck& check, const std::vector<double>& utilisations) {
        (check.flaws & weak ? breaks : bears) = true;
        for (size_t k = 0; k < low.size(); ++k)
            low[k] = std::min(low[k], utilisations[k]), high[k] = std::max(high[k], utilisations[k]);
    }

    // Whether a joint that differs by more than `spread` breaks with some of them alone.
    bool decides(double spread) const {
        for (size_t k = 0; bears && breaks && k < low.size(); ++k)
            if (low[k] <= 1.0 && high[k] > 1.0 && high[k] > low[k] + spread) return true;
        return false;
    }
};

}  // namespace

ManySprings::ManySprings(Piece piece, std::vector<Springs> springs)
    : model_(std::move(piece)),
      springs_(std::move(springs)),
      order_(springs_.size()),
      known_(springs_.size(), model_.states()) {
    std::iota(order_.begin(), order_.end(), 0);
}

ManySprings::Found ManySprings::test(const double* gamma, int ending) {
    Found found;
    DesignCheck held;
    const bool goes_on = model_.hold(gamma, every_flaw, false, held);
    for (const Springs& springs : springs_) {
        DesignCheck check = held;
        std::vector<double> utilisations(joints(), 0.0);
        if (goes_on) {
            set(springs);
            model_.forget();
            model_.bear(check, &utilisations);
        }
        found.flaws.push_back(check.flaws & every_flaw);
        found.utilisations.push_back(std::move(utilisations));
        found.sprung.push_back(check.sprung);
        if (check.flaws & ending) break;
    }
    return found;
}

bool ManySprings::decide(const double* gamma, double spread) {
    DesignCheck held;
    if (!model_.hold(gamma, every_flaw, true, held)) return false;
    // Springs of which one-sided contacts are not solved count only where no others are.
    Spread solved(joints()), sprung(joints());
    bool any_solved = false;
    for (size_t k = 0; k < order_.size(); ++k) {
        const Springs& springs = springs_[order_[k]];
        // What is found already can only be undone by a case without an equilibrium.
        if (solved.decides(spread)) {
            set(springs);
            if (!model_.springs_rest()) return false;
            continue;
        }
        DesignCheck check;
        std::vector<double> utilisations(joints(), 0.0);
        set(springs);
        model_.exchange(known_[order_[k]]);
        model_.bear(check, &utilisations);
        model_.exchange(known_[order_[k]]);
        if (check.flaws & unbalanced) return false;
        any_solved = any_solved || !check.sprung;
        (check.sprung ? sprung : solved).add(check, utilisations);
        if (solved.decides(spread)) std::rotate(order_.begin(), order_.begin() + k, order_.begin() + k + 1);
    }
    return (any_solved ? solved : sprung).decides(spread);
}

void ManySprings::forget() {
    model_.forget();
    for (auto& cases : known_)
        for (CaseState& state : cases) state.found = false;
}

}  // namespace restshape::planks
