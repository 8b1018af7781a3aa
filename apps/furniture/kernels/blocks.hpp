// A sparse matrix of 6 x 6 blocks, one row a plank, with its LU factors in an order of least degree.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace restshape::planks {

using Block = Eigen::Matrix<double, 6, 6>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Blocks {
 public:
    Blocks() = default;

    // pairs: planks that a joint connects.
    Blocks(int n, const std::vector<std::pair<int, int>>& pairs);

    int size() const { return n_; }
    const std::vector<int>& order() const { return order_; }
    void clear() {
        for (Block& b : values_) b.setZero();
    }
    // Keeps a copy of the matrix, and overwrites the matrix by it.
    void keep() { kept_ = values_; }
    void restore() { values_ = kept_; }
    Block& at(int i, int j) { return values_[slot_[i * n_ + j]]; }

    // Overwrites the matrix by its factors.
    void factor();

    // Overwrites the right sides (6 n, m) by the solutions.
    void solve(Rows& b);
    void solve(std::vector<double>& b);

 private:
    int n_ = 0;
    std::vector<int> order_, slot_;
    std::vector<std::vector<int>> later_;
    std::vector<Block> values_, inverse_, kept_;
};

}  // namespace restshape::planks
