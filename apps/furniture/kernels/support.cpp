// A load's nearest point in a cone, one force at a time.
#include "support.hpp"

#include <Eigen/QR>

namespace restshape::planks {

namespace {

constexpr int most_steps = 300;
constexpr double most_force = 1e3;  // of the sum of the normal forces, in parts of the load

// Least squares with non-negative weights (Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23) over
// all forces inside the friction cones: the one that fits what remains best is found in closed form at each contact.
class ConeProjection {
 public:
    ConeProjection(const Contacts& contacts, const Wrench& load) : C(contacts), load_(load), size_(load.norm()) {}

    // Begins with forces that fit the load as well as they can.
    void begin(const std::vector<ConeForce>& forces) {
        for (const ConeForce& one : forces) add(one.contact, one.force, one.weight);
        fit();
    }

    // Whether what was found is proved: the forces give the load, or no forces do.
    bool solve(double tolerance) {
        rest_ = load_ - given();
        for (int step = 0; step < most_steps && rest_.norm() > tolerance * size_; ++step) {
            const auto [gain, contact, force] = best(rest_);
            // All that the contacts can give is at least a right angle away from the rest: it cannot be given.
            if (gain * most_force * size_ < rest_.squaredNorm()) return true;
            add(contact, force, 0.0);
            fit();
            const Wrench now = load_ - given();
            const bool stays = now.norm() > (1.0 - 1e-14) * rest_.norm();
            rest_ = now;
            if (stays) break;
        }
        return rest_.norm() <= tolerance * size_;
    }

    Support found() const { return {size_ > 0.0 ? rest_.norm() / size_ : 0.0, active_, fits_}; }

 private:
    struct Best {
        double gain;
        int contact;
        V3<double> force;
    };
    const Contacts& C;
    Wrench load_, rest_;
    double size_;
    int fits_ = 0;
    std::vector<ConeForce> active_;
    std::vector<Wrench> wrenches_;  // of the active forces

    // The force of a unit normal part that goes along with the rest most.
    Best best(const Wrench& rest) const {
        Best found{-1.0, -1, {}};
        const V3<double> push{rest[0], rest[1], rest[2]}, spin{rest[3], rest[4], rest[5]};
        for (size_t k = 0; k < C.points.size(); ++k) {
            const V3<double> q = push + cross(spin, C.points[k]);
            const double along_normal = dot(q, C.normals[k]);
            const V3<double> t = q - scaled(C.normals[k], along_normal);
            const double size = std::sqrt(dot(t, t)), gain = along_normal + C.mu[k] * size;
            if (gain <= found.gain) continue;
            const double part = size > 1e-300 ? C.mu[k] / size : 0.0;
            found = {gain, static_cast<int>(k), C.normals[k] + scaled(t, part)};
        }
        return found;
    }

    void add(int contact, const V3<double>& force, double weight) {
        const V3<double> moment = cross(C.points[contact], force);
        Wrench w;
        w << force[0], force[1], force[2], moment[0], moment[1], moment[2];
        active_.push_back({contact, force, weight});
        wrenches_.push_back(w);
    }

    Wrench given() const {
        Wrench sum = Wrench::Zero();
        for (size_t k = 0; k < active_.size(); ++k) sum += active_[k].weight * wrenches_[k];
        return sum;
    }

    // The non-negative weights of the active forces that leave the least; those that come to 0 are dropped.
    void fit() {
        while (!active_.empty()) {
            Eigen::Matrix<double, 6, Eigen::Dynamic> a(6, active_.size());
            for (size_t k = 0; k < active_.size(); ++k) a.col(k) = wrenches_[k];
            Eigen::ColPivHouseholderQR<decltype(a)> factors(a);
            factors.setThreshold(1e-13);
            ++fits_;
            const Eigen::VectorXd z = factors.solve(load_);
            double step = 1.0;
            for (size_t k = 0; k < active_.size(); ++k)
                if (z[k] <= 0.0) step = std::min(step, active_[k].weight / std::max(active_[k].weight - z[k], 1e-300));
            for (size_t k = 0; k < active_.size(); ++k) active_[k].weight += step * (z[k] - active_[k].weight);
            if (step == 1.0) return;
            size_t kept = 0;
            for (size_t k = 0; k < active_.size(); ++k)
                if (active_[k].weight > 1e-15) active_[kept] = active_[k], wrenches_[kept++] = wrenches_[k];
            active_.resize(kept), wrenches_.resize(kept);
        }
    }
};

}  // namespace

Support balance(const Contacts& contacts, const Wrench& load, double tolerance) {
    ConeProjection search(contacts, load);
    search.solve(tolerance);
    return search.found();
}

Support balance_from(const std::vector<ConeForce>& near, const Contacts& contacts, const Wrench& load,
                     double tolerance) {
    if (near.empty()) return balance(contacts, load, tolerance);
    ConeProjection search(contacts, load);
    search.begin(near);
    const bool proved = search.solve(tolerance);
    Support found = search.found();
    if (proved) return found;
    const int vain = found.fits;
    found = balance(contacts, load, tolerance), found.fits += vain;
    return found;
}

}  // namespace restshape::planks
