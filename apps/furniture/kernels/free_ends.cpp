// What lies before, in or beside each end of a plank.
#include "free_ends.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "piece.hpp"

namespace restshape::planks {

namespace {

V3<double> absolute(const V3<double>& a) { return {std::abs(a[0]), std::abs(a[1]), std::abs(a[2])}; }

// One end: its middle, the way out of it, and half of its line.
class End {
 public:
    End(const LyingPlanks& lying, const Nearness& near, int plank, int side)
        : L(lying), N(near), i_(plank), side_(side), a_(axis_of(side)) {
        axis_ = scaled(column(L.axes[i_], a_), sign_of(side));
        middle_ = L.centre[i_] + scaled(axis_, 0.5 * L.size[i_][a_]);
        line_ = scaled(column(L.axes[i_], 1 - a_), 0.5 * L.size[i_][1 - a_]);
    }

    // The nearest thing that it missed.
    std::optional<FreeEnd> nearest() const {
        std::vector<FreeEnd> found;
        const auto add = [&](const std::optional<FreeEnd>& one) {
            if (one) found.push_back(*one);
        };
        const int n = static_cast<int>(L.centre.size());
        for (int j = 0; j < n; ++j)
            if (j != i_ && ahead(j)) add(before(j));
        add(above());
        for (int j = 0; j < n; ++j)
            if (j != i_ && !joined(j)) add(at_edge(j));
        const auto distance = [](const FreeEnd& one) { return std::abs(one.gap) + one.aside; };
        const auto best = std::min_element(found.begin(), found.end(), [&](const FreeEnd& one, const FreeEnd& other) {
            return distance(one) < distance(other);
        });
        return best == found.end() ? std::nullopt : std::optional(*best);
    }

 private:
    const LyingPlanks& L;
    const Nearness& N;
    int i_, side_, a_;
    V3<double> axis_, middle_, line_;

    double most() const { return std::min(N.far, 0.5 * L.size[i_][a_]); }

    bool joined(int j) const {
        const std::pair<int, int> one{i_, j}, other{j, i_};
        return std::any_of(L.joined.begin(), L.joined.end(), [&](const auto& k) { return k == one || k == other; });
    }

    // Whether it looks at a plank from near, by the middle and the normal of that.
    bool ahead(int j) const {
        const V3<double> normal = column(L.axes[j], 2);
        return std::abs(dot(normal, axis_)) > N.least_slant &&
               std::abs(dot(L.centre[j] - middle_, normal)) <= N.far + N.beyond + L.size[j][2];
    }

    // The end before, in or beside a face of a plank; none where it is far from it.
    std::optional<FreeEnd> before(int j) const {
        const V3<double>& size = L.size[j];
        const double slope = dot(axis_, column(L.axes[j], 2));
        V3<double> place = transposed_times(L.axes[j], middle_ - L.centre[j]);
        const double gap = (std::copysign(0.5, -slope) * size[2] - place[2]) / slope;
        if (!(-most() <= gap && gap <= most())) return {};
        const V3<double> half = absolute(transposed_times(L.axes[j], line_));
        place = place + scaled(transposed_times(L.axes[j], axis_), gap);
        bool through = true, strip = false;
        double aside = 0.0;
        for (int k = 0; k < 2; ++k) {
            // The line of the end, not its middle alone, may meet the face.
            const double beside = std::abs(place[k]) - 0.5 * size[k] - half[k];
            if (beside > N.edge) aside = std::hypot(aside, beside);
            // What only touches it with a strip, or would take its end from planks that it carries, was not drawn to
            // end there.
            through = through && beside < -N.flush && std::abs(place[k]) <= 0.5 * size[k] + N.edge;
            // A line that reaches the side of a face does not lie on it.
            strip = strip || (beside > -N.edge && half[k] > N.edge);
        }
        if (gap < -N.reach && carries(gap)) return {};
        if (aside > N.aside || joined(j) || !(through || gap >= -std::min(N.beyond, size[2] + N.reach))) return {};
        FreeEnd found{i_, side_, j, gap, aside, half[2] > N.reach};
        if (aside > 0.0 || strip) found.way = onto(j, place, half);
        return found;
    }

    // The shortest way of the end from a place onto all of a face of a plank.
    V3<double> onto(int j, const V3<double>& place, const V3<double>& half) const {
        const V3<double> thick = absolute(transposed_times(L.axes[j], column(L.axes[i_], 2)));
        V3<double> way{0.0, 0.0, 0.0};
        for (int k = 0; k < 2; ++k) {
            const double room = std::max(0.5 * L.size[j][k] - (half[k] + 0.5 * thick[k] * L.size[i_][2]), 0.0);
            way = way + scaled(column(L.axes[j], k), std::clamp(place[k], -room, room) - place[k]);
        }
        return way;
    }

    // Whether ends of planks are joined to the part that the plank loses with its end `gap` from where it is.
    bool carries(double gap) const {
        for (size_t k = 0; k < L.joined.size(); ++k) {
            const auto [i, j] = L.joined[k];
            if (j != i_) continue;
            const int side = L.joined_side[k], a = axis_of(side);
            const V3<double> end = L.centre[i] + scaled(column(L.axes[i], a), 0.5 * sign_of(side) * L.size[i][a]);
            if (dot(end - middle_, axis_) > gap) return true;
        }
        return false;
    }

    // The end above the floor, as the foot of a leg that is too short; none where it is far from it.
    std::optional<FreeEnd> above() const {
        const double slope = -dot(axis_, L.floor_normal);
        if (slope <= N.least_slant) return {};
        const double gap = dot(middle_ - L.floor_point, L.floor_normal) / slope;
        if (std::abs(gap) > most()) return {};
        return FreeEnd{i_, side_, -1, gap, 0.0, std::abs(dot(line_, L.floor_normal)) > N.reach};
    }

    // The end before an edge of a plank, no farther than joints reach.
    std::optional<FreeEnd> at_edge(int j) const {
        const V3<double>& size = L.size[j];
        const V3<double> way = transposed_times(L.axes[j], axis_), along = transposed_times(L.axes[j], line_);
        const V3<double> place = transposed_times(L.axes[j], middle_ - L.centre[j]), steep = absolute(way);
        // The axis of the plank that it looks along.
        const int k = static_cast<int>(std::max_element(steep.begin(), steep.end()) - steep.begin());
        if (k == 2) return {};
        const double gap = (std::copysign(0.5, -way[k]) * size[k] - place[k]) / way[k];
        if (!(gap >= -N.flush && gap <= N.reach)) return {};
        for (int c : {1 - k, 2})
            if (!(std::abs(place[c] + gap * way[c]) - std::abs(along[c]) - 0.5 * size[c] < -N.flush)) return {};
        FreeEnd found{i_, side_, j, gap};
        found.edge = true;
        return found;
    }
};

}  // namespace

std::vector<FreeEnd> free_ends(const LyingPlanks& lying, const Nearness& near, const std::vector<int>& planks) {
    std::vector<FreeEnd> found;
    for (int i : planks) {
        const int along = lying.size[i][1] > lying.size[i][0] ? 1 : 0;
        for (int side : {2 * along, 2 * along + 1}) {
            if (lying.held[6 * i + side]) continue;
            if (const auto one = End(lying, near, i, side).nearest()) found.push_back(*one);
        }
    }
    return found;
}

}  // namespace restshape::planks
