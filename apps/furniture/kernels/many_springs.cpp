// The tests of a piece with many springs: what no compliance changes is tested once.
#include "many_springs.hpp"

#include <algorithm>
#include <limits>

namespace restshape::planks {

ManySprings::ManySprings(Piece piece, std::vector<Springs> springs)
    : model_(std::move(piece)), springs_(std::move(springs)) {}

ManySprings::Found ManySprings::test(const double* gamma, int ending) {
    Found found;
    DesignCheck held;
    const bool goes_on = model_.hold(gamma, every_flaw, false, held);
    for (const Springs& springs : springs_) {
        DesignCheck check = held;
        std::vector<double> utilisations(joints(), 0.0);
        if (goes_on) bear(springs, check, utilisations);
        found.flaws.push_back(check.flaws & every_flaw);
        found.utilisations.push_back(std::move(utilisations));
        if (check.flaws & ending) break;
    }
    return found;
}

bool ManySprings::decide(const double* gamma, double spread) {
    DesignCheck held;
    if (!model_.hold(gamma, every_flaw, false, held) || (held.flaws & every_flaw)) return false;
    std::vector<double> low(joints(), std::numeric_limits<double>::infinity()), high(joints(), 0.0);
    bool bears = false, breaks = false, found = false;
    for (const Springs& springs : springs_) {
        DesignCheck check;
        std::vector<double> utilisations(joints(), 0.0);
        // What is found already can only be undone by a case without an equilibrium.
        if (found) {
            set(springs);
            if (!model_.springs_rest()) return false;
            continue;
        }
        bear(springs, check, utilisations);
        if (check.flaws & unbalanced) return false;
        (check.flaws & weak ? breaks : bears) = true;
        for (int k = 0; k < joints(); ++k) {
            low[k] = std::min(low[k], utilisations[k]), high[k] = std::max(high[k], utilisations[k]);
            found = found || (bears && breaks && low[k] <= 1.0 && high[k] > 1.0 && high[k] > low[k] + spread);
        }
    }
    return found;
}

void ManySprings::bear(const Springs& springs, DesignCheck& check, std::vector<double>& utilisations) {
    set(springs);
    model_.forget();
    model_.bear(check, &utilisations);
}

}  // namespace restshape::planks
