// The tests of a piece with many springs: what no compliance changes is tested once.
#include "many_springs.hpp"

namespace restshape::planks {

ManySprings::ManySprings(Piece piece, std::vector<Springs> springs)
    : model_(std::move(piece)), springs_(std::move(springs)), states_(springs_.size(), model_.states()) {}

void ManySprings::forget() {
    for (auto& states : states_) model_.swap_states(states), model_.forget(), model_.swap_states(states);
}

ManySprings::Found ManySprings::test(const double* gamma, int ending) {
    Found found;
    DesignCheck held;
    const bool goes_on = model_.hold(gamma, every_flaw, false, held);
    std::vector<double> left;
    for (const CaseState& state : model_.states()) left.push_back(state.unbalanced_load);
    for (size_t k = 0; k < springs_.size(); ++k) {
        DesignCheck check = held;
        std::vector<double> utilisations(joints(), 0.0);
        if (goes_on) {
            auto& states = states_[k];
            for (size_t c = 0; c < states.size(); ++c) states[c].unbalanced_load = left[c];
            model_.set_compliance(springs_[k].eps_t, springs_[k].eps_r, springs_[k].eps_floor);
            model_.swap_states(states);
            model_.bear(check, &utilisations);
            model_.swap_states(states);
        }
        found.flaws.push_back(check.flaws & every_flaw);
        found.utilisations.push_back(std::move(utilisations));
        if (check.flaws & ending) break;
    }
    return found;
}

}  // namespace restshape::planks
