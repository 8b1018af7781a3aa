// An incomplete Cholesky factor without fill, of blocks of 3 by 3, that no positive definite matrix breaks.
#pragma once

#include <petscmat.h>

#include <cstdint>
#include <vector>

namespace restshape {

// A ~ (I + L) D (I + L)^T with the pattern of A, of A whose diagonal is larger by a share. A pivot that the updates
// leave indefinite is that of A instead, so that the factor is positive definite wherever A's own blocks are. Kept in
// single precision: it is read twice an iteration, and the memory is what that takes its time for.
//
// Source: J. A. Meijerink and H. A. van der Vorst, Math. Comp. 31 (1977) 148; T. A. Manteuffel, Math. Comp. 34 (1980)
// 473.
class BlockFactor {
 public:
    explicit BlockFactor(double shift) : shift_(shift) {}

    // Of a SeqAIJ whose rows come in threes that have the same columns, in threes as well; false for another one.
    bool compute(Mat mat);
    // z = the factor's inverse times r.
    void solve(const double* r, double* z);
    int kept_pivots() const { return kept_pivots_; }  // how many are A's own

 private:
    static constexpr int f = 3, lanes = 4, block = f * lanes;  // columns of a block are padded

    struct Update {
        int32_t left, right;  // block (i, j) loses scaled (i, k) times the transposed block (j, k)
    };

    bool read_pattern(const PetscInt* row, const PetscInt* column, int rows);
    void collect_updates();
    void factorize(const PetscInt* row, const double* value);
    void pivot(int node, const float* own, float* D);

    double shift_;
    int nodes_ = 0, kept_pivots_ = 0;
    PetscObjectId of_ = 0;
    PetscObjectState pattern_ = -1;
    std::vector<int32_t> start_, column_;  // of the blocks left of the diagonal
    std::vector<int32_t> place_;           // of a block among those of its row of A
    std::vector<int32_t> diagonal_;        // place of the diagonal
    std::vector<int32_t> first_update_;    // of each block
    std::vector<Update> updates_;
    std::vector<float> lower_, inverse_, scaled_, work_;
};

}  // namespace restshape
