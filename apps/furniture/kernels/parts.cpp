// Parts by a union of planks along joints, and the eigenvectors that no contact stiffens.
#include "parts.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace restshape::planks {

namespace {

constexpr double least_eigenvalue = 1e-9;  // in parts of the largest, of a motion that is held

}  // namespace

std::vector<Part> parts_of(const Piece& piece) {
    const int n = piece.count();
    std::vector<int> of(n);
    for (int i = 0; i < n; ++i) of[i] = i;
    const auto root = [&of](int i) {
        while (of[i] != i) i = of[i] = of[of[i]];
        return i;
    };
    for (const JointSpec& joint : piece.joints) of[root(joint.i)] = root(joint.j);
    std::vector<Part> parts;
    std::vector<int> index(n, -1);
    for (int i = 0; i < n; ++i) {
        int& k = index[root(i)];
        if (k < 0) k = static_cast<int>(parts.size()), parts.emplace_back();
        parts[k].planks.push_back(i);
    }
    for (const FootSpec& foot : piece.feet) {
        Part& part = parts[index[root(foot.plank)]];
        part.grounded = true;
        if (part.carrier < 0) part.carrier = foot.plank;
    }
    for (Part& part : parts)
        if (part.carrier < 0) part.carrier = part.planks[0];
    return parts;
}

std::vector<Motion> free_motions(const Eigen::Matrix<double, 6, 6>& stiffness, double reach) {
    Motion scale;
    scale << 1, 1, 1, 1, 1, 1;
    if (reach > 0.0) scale.tail<3>().setConstant(1.0 / reach);
    using Six = Eigen::Matrix<double, 6, 6>;
    const Six scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
    // Where all eigenvalues are a thousand times what counts as none, as they mostly are, factors say so.
    if (Eigen::LLT<Six>(scaled - 1e3 * least_eigenvalue * scaled.trace() * Six::Identity()).info() == Eigen::Success)
        return {};
    const Eigen::SelfAdjointEigenSolver<Six> found(scaled);
    const double most = std::max(found.eigenvalues()[5], 1e-300);
    std::vector<Motion> free;
    for (int m = 0; m < 6; ++m)
        if (found.eigenvalues()[m] <= least_eigenvalue * most)
            free.push_back((scale.asDiagonal() * found.eigenvectors().col(m)).normalized());
    return free;
}

}  // namespace restshape::planks
