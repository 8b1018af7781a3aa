// A load's nearest point in a cone, one force at a time.
#include "support.hpp"

#include <Eigen/QR>

namespace restshape::planks {

// Least squares with non-negative weights (Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23) over
// all forces inside the friction cones: the one that fits what remains best is found in closed form at each contact.
class ConeProjection {
 public:
    ConeProjection(const std::vector<V3<double>>& points, const std::vector<V3<double>>& normals,
                   const std::vector<double>& mu, const Wrench& load)
        : points_(points), normals_(normals), mu_(mu), load_(load) {}

    Support solve(double tolerance) {
        Wrench rest = load_;
        const double size = load_.norm();
        for (int step = 0; step < most_steps && rest.norm() > tolerance * size; ++step) {
            const auto [gain, contact, force] = best(rest);
            // All that the contacts can give is at least a right angle away from the rest: it cannot be given.
            if (gain * most_force * size < rest.squaredNorm()) break;
            add(contact, force);
            fit();
            const Wrench now = load_ - given();
            if (now.norm() > (1.0 - 1e-14) * rest.norm()) {
                rest = now;
                break;
            }
            rest = now;
        }
        Support support{size > 0.0 ? rest.norm() / size : 0.0, {}};
        support.forces.assign(points_.size(), {0.0, 0.0, 0.0});
        for (size_t k = 0; k < active_.size(); ++k)
            for (int a = 0; a < 3; ++a) support.forces[active_[k].contact][a] += weights_[k] * active_[k].force[a];
        return support;
    }

 private:
    static constexpr int most_steps = 300;
    static constexpr double most_force = 1e3;  // of the sum of the normal forces, in parts of the load
    struct Active {
        int contact;
        V3<double> force;
        Wrench wrench;
    };
    struct Best {
        double gain;
        int contact;
        V3<double> force;
    };
    const std::vector<V3<double>>&points_, &normals_;
    const std::vector<double>& mu_;
    Wrench load_;
    std::vector<Active> active_;
    std::vector<double> weights_;

    // The force of a unit normal part that goes along with the rest most.
    Best best(const Wrench& rest) const {
        Best found{-1.0, -1, {}};
        const V3<double> push{rest[0], rest[1], rest[2]}, spin{rest[3], rest[4], rest[5]};
        for (size_t k = 0; k < points_.size(); ++k) {
            const V3<double> q = push + cross(spin, points_[k]);
            const double along_normal = dot(q, normals_[k]);
            const V3<double> t = q - scaled(normals_[k], along_normal);
            const double size = std::sqrt(dot(t, t)), gain = along_normal + mu_[k] * size;
            if (gain <= found.gain) continue;
            const double part = size > 1e-300 ? mu_[k] / size : 0.0;
            found = {gain, static_cast<int>(k), normals_[k] + scaled(t, part)};
        }
        return found;
    }

    void add(int contact, const V3<double>& force) {
        const V3<double> moment = cross(points_[contact], force);
        Wrench w;
        w << force[0], force[1], force[2], moment[0], moment[1], moment[2];
        active_.push_back({contact, force, w});
        weights_.push_back(0.0);
    }

    Wrench given() const {
        Wrench sum = Wrench::Zero();
        for (size_t k = 0; k < active_.size(); ++k) sum += weights_[k] * active_[k].wrench;
        return sum;
    }

    // The non-negative weights of the active forces that leave the least; those that come to 0 are dropped.
    void fit() {
        while (!active_.empty()) {
            Eigen::Matrix<double, 6, Eigen::Dynamic> a(6, active_.size());
            for (size_t k = 0; k < active_.size(); ++k) a.col(k) = active_[k].wrench;
            Eigen::ColPivHouseholderQR<decltype(a)> factors(a);
            factors.setThreshold(1e-13);
            const Eigen::VectorXd z = factors.solve(load_);
            double step = 1.0;
            for (size_t k = 0; k < active_.size(); ++k)
                if (z[k] <= 0.0) step = std::min(step, weights_[k] / std::max(weights_[k] - z[k], 1e-300));
            for (size_t k = 0; k < active_.size(); ++k) weights_[k] += step * (z[k] - weights_[k]);
            if (step == 1.0) return;
            size_t kept = 0;
            for (size_t k = 0; k < active_.size(); ++k)
                if (weights_[k] > 1e-15) active_[kept] = active_[k], weights_[kept++] = weights_[k];
            active_.resize(kept), weights_.resize(kept);
        }
    }
};

Support balance(const std::vector<V3<double>>& points, const std::vector<V3<double>>& normals,
                const std::vector<double>& mu, const Wrench& load, double tolerance) {
    return ConeProjection(points, normals, mu, load).solve(tolerance);
}

}  // namespace restshape::planks
