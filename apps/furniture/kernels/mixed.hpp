// The mixed form of the equilibrium: joint forces beside displacements, so that stiff joints do not spoil the system.
#pragma once

#include <tuple>

#include "state.hpp"

namespace restshape::planks {

// Unknowns: six forces a joint first, which eliminates them first, then six displacements a plank in the order of
// least degree. Rows of joints hold d / eps - h.
class Mixed {
 public:
    explicit Mixed(const State& state);

    int size() const { return 6 * (nj_ + P.count()); }
    std::pair<std::vector<int>, std::vector<int>> pattern() const { return {rows_, columns_}; }

    void residual(int load_case, Law law, const double* z, double* out) const;

    // Values in the pattern; `shift` times the joints' stiffness is added to the diagonal of displacements.
    void tangent(int load_case, Law law, const double* z, double* values, double shift) const;

    double energy(int load_case, const double* z) const;

    // The unknowns at the state of a case.
    std::vector<double> join(int load_case) const;

    // The displacements (6 a plank) among the unknowns.
    std::vector<double> part(const double* z) const;

 private:
    State S;
    const Piece& P;
    int nj_;
    std::vector<int> at_;
    std::vector<std::vector<int>> links_;
    std::vector<int> rows_, columns_;

    double stiffness(int k) const;

    void link(int i, int j);

    void build();

    // Entries of a block lie side by side in each row.
    double* find(double* values, int r, int c) const;
    void put(double* values, int r, int c, double v) const { *find(values, r, c) += v; }

    void joint(int k, const double* z, const double* x, double* values) const;

    void plank_terms(int load_case, Law law, const double* x, double* values) const;
};

}  // namespace restshape::planks
