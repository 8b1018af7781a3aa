// How far a piece is from tipping and sliding, over any scalar: moments about hull edges, and friction.
#pragma once

#include <algorithm>

#include "equilibrium.hpp"

namespace restshape::planks {

// Corners, counter-clockwise, of the convex hull of points in a plane (Andrew's monotone chain).
inline std::vector<int> hull(const std::vector<std::array<double, 2>>& points, double tolerance) {
    std::vector<int> order(points.size());
    for (size_t k = 0; k < points.size(); ++k) order[k] = static_cast<int>(k);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return points[a] < points[b]; });
    const auto left = [&](int a, int b, int c) {
        const double u = points[b][0] - points[a][0], v = points[b][1] - points[a][1];
        return u * (points[c][1] - points[a][1]) - v * (points[c][0] - points[a][0]) > tolerance;
    };
    std::vector<int> found;
    for (int pass = 0; pass < 2; ++pass) {
        const size_t first = found.size();
        for (int k : order) {
            while (found.size() >= first + 2 && !left(found[found.size() - 2], found.back(), k)) found.pop_back();
            found.push_back(k);
        }
        found.pop_back();
        std::reverse(order.begin(), order.end());
    }
    return found;
}

// What the loads do to each part on the floor: the moment about each edge of the hull of its contacts, in parts of
// weight times size, positive where it holds the part down; and what friction has left over, in parts of weight.
// A part whose contacts lie in one line, or on several planes, has no rows.
template <class T>
class StabilityRows {
 public:
    StabilityRows(const Piece& piece, const Equilibrium& equilibrium, const Shape<T>& shape, int load_case,
                  std::vector<T>& rows)
        : P(piece), S(shape), case_(load_case), rows_(rows) {
        for (const Part& part : equilibrium.parts()) add(part);
    }

 private:
    const Piece& P;
    const Shape<T>& S;
    int case_;
    std::vector<T>& rows_;

    struct Force {
        V3<T> at, force;
    };

    void add(const Part& part) {
        std::vector<const Contact<T>*> contacts;
        for (const auto& contact : S.contacts)
            if (std::find(part.planks.begin(), part.planks.end(), contact.plank) != part.planks.end())
                contacts.push_back(&contact);
        if (contacts.empty()) return;
        const V3<double> n = contacts[0]->normal;
        double mu = 0.0;
        for (const auto* contact : contacts) {
            if (dot(contact->normal, n) < 1.0 - 1e-12) return;
            mu = std::max(mu, contact->mu);
        }
        const V3<double> e1 = std::abs(n[0]) < 0.9 ? cross(n, V3<double>{1, 0, 0}) : cross(n, V3<double>{0, 1, 0});
        const V3<double> e2 = cross(n, e1);
        std::vector<std::array<double, 2>> flat;
        for (const auto* contact : contacts) {
            const V3<T> from_first = contact->point - contacts[0]->point;
            flat.push_back({value(dot(from_first, e1)), value(dot(from_first, e2))});
        }
        const T size = apart(contacts, flat);
        const std::vector<int> corners = hull(flat, 1e-9 * value(size) * value(size));
        const std::vector<Force> forces = loads(part);
        T weight(0.0);
        V3<T> sum{T(0.0), T(0.0), T(0.0)};
        for (const Force& f : forces) weight -= dot(f.force, n), sum = sum + f.force;
        for (size_t k = 0; corners.size() > 2 && k < corners.size(); ++k) {
            const V3<T>& a = contacts[corners[k]]->point;
            const V3<T> edge = contacts[corners[(k + 1) % corners.size()]]->point - a;
            T moment(0.0);
            for (const Force& f : forces) moment -= dot(edge, cross(f.at - a, f.force));
            using std::sqrt;
            rows_.push_back(moment / (sqrt(dot(edge, edge)) * weight * size));
        }
        const V3<T> along = sum + scaled(V3<double>(n), weight);
        const T size2 = dot(along, along);
        using std::sqrt;
        if (value(size2) > 0.0) rows_.push_back(mu - sqrt(size2) / weight);
    }

    // How far the two outermost contacts are apart.
    static T apart(const std::vector<const Contact<T>*>& contacts, const std::vector<std::array<double, 2>>& flat) {
        size_t first = 0, last = 0;
        double most = 0.0;
        for (size_t a = 0; a < flat.size(); ++a)
            for (size_t b = 0; b < a; ++b) {
                const double far = std::hypot(flat[a][0] - flat[b][0], flat[a][1] - flat[b][1]);
                if (far > most) most = far, first = a, last = b;
            }
        if (most == 0.0) return T(0.0);
        const V3<T> way = contacts[first]->point - contacts[last]->point;
        using std::sqrt;
        return sqrt(dot(way, way));
    }

    std::vector<Force> loads(const Part& part) const {
        std::vector<Force> forces;
        for (int i : part.planks) {
            const T& mass = S.mass[i];
            forces.push_back({S.centre[i], {mass * P.gravity[0], mass * P.gravity[1], mass * P.gravity[2]}});
        }
        for (size_t k = 0; k < P.loads.size(); ++k) {
            const int i = P.loads[k].plank;
            if (std::find(part.planks.begin(), part.planks.end(), i) == part.planks.end()) continue;
            const auto& load = P.cases[case_][k];
            forces.push_back({S.centre[i] + S.load_arms[k], {T(load[0]), T(load[1]), T(load[2])}});
        }
        return forces;
    }
};

}  // namespace restshape::planks
