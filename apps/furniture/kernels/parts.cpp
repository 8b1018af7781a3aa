// Parts by a union of planks along joints, and the eigenvectors that no contact stiffens.
#include "parts.hpp"

#include <Eigen/Eigenvalues>

namespace restshape::planks {

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
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> found(scale.asDiagonal() * stiffness *
                                                                           scale.asDiagonal());
    const double most = std::max(found.eigenvalues()[5], 1e-300);
    std::vector<Motion> free;
    for (int m = 0; m < 6; ++m)
        if (found.eigenvalues()[m] <= 1e-9 * most)
            free.push_back((scale.asDiagonal() * found.eigenvectors().col(m)).normalized());
    return free;
}

}  // namespace restshape::planks
