// The contacts and the loads of a part, in lengths of how far its contacts are from their middle.
#include "footing.hpp"

#include <cmath>

namespace restshape::planks {

Footing::Footing(const Piece& piece, const Shape<double>& shape, const Part& part)
    : P(piece), S(shape), mine_(piece.count(), 0) {
    for (int i : part.planks) mine_[i] = 1;
    for (size_t k = 0; k < S.contacts.size(); ++k) {
        const auto& contact = S.contacts[k];
        if (!mine_[contact.plank]) continue;
        contacts_.points.push_back(contact.point), contacts_.normals.push_back(contact.normal);
        contacts_.mu.push_back(contact.mu), number_.push_back(k);
    }
    auto& points = contacts_.points;
    for (const auto& p : points) middle_ = middle_ + scaled(p, 1.0 / points.size());
    for (auto& p : points) p = p - middle_, reach_ = std::max(reach_, std::sqrt(dot(p, p)));
    for (auto& p : points) p = scaled(p, 1.0 / reach_);
    for (int i : part.planks) add(own_, S.centre[i], scaled(P.gravity, S.mass[i]));
}

void Footing::add(Sum& sum, const V3<double>& at, const V3<double>& force) const {
    sum.force = sum.force - force, sum.moment = sum.moment - cross(scaled(at - middle_, 1.0 / reach_), force);
    sum.size += std::sqrt(dot(force, force));
}

std::pair<Wrench, double> Footing::load(int load_case) const {
    Sum sum = own_;
    for (size_t k = 0; k < P.loads.size(); ++k)
        if (const int i = P.loads[k].plank; mine_[i]) add(sum, S.centre[i] + S.load_arms[k], P.cases[load_case][k]);
    Wrench load;
    load << sum.force[0], sum.force[1], sum.force[2], sum.moment[0], sum.moment[1], sum.moment[2];
    return {load, sum.size};
}

Support Footing::support(int load_case, double tolerance, const std::vector<ConeForce>& near) const {
    if (number_.empty()) return {1.0};
    const auto [load, size] = this->load(load_case);
    return size == 0.0 ? Support() : balance_from(near, contacts_, load / size, tolerance);
}

void Footing::put(const Support& support, int load_case, std::vector<V3<double>>& forces) const {
    for (const ConeForce& one : support.forces) {
        V3<double>& sum = forces[number_[one.contact]];
        sum = sum + scaled(one.force, one.weight);
    }
    const double size = load(load_case).second;
    for (const size_t k : number_) forces[k] = scaled(forces[k], size);
}

}  // namespace restshape::planks
