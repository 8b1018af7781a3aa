// Distance of points from straight pieces.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>

namespace restshape {

// Straight pieces, stored by coordinate so that one point meets several of them at once.
class Pieces {
 public:
    Pieces(const double* starts, const double* ends, std::ptrdiff_t n) : x_(n), y_(n), dx_(n), dy_(n), scale_(n) {
        for (std::ptrdiff_t i = 0; i < n; ++i) {
            x_[i] = starts[2 * i];
            y_[i] = starts[2 * i + 1];
            dx_[i] = ends[2 * i] - x_[i];
            dy_[i] = ends[2 * i + 1] - y_[i];
            const double length2 = dx_[i] * dx_[i] + dy_[i] * dy_[i];
            scale_[i] = length2 > 0 ? 1 / length2 : 0;
        }
    }

    double distance(double px, double py) const {
        const auto ax = px - x_, ay = py - y_;
        // Eigen evaluates all of this in one pass over the pieces.
        const auto t = ((ax * dx_ + ay * dy_) * scale_).max(0.0).min(1.0);
        return std::sqrt(((ax - t * dx_).square() + (ay - t * dy_).square()).minCoeff());
    }

 private:
    Eigen::ArrayXd x_, y_, dx_, dy_, scale_;
};

}  // namespace restshape
