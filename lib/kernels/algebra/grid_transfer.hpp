// Interpolation between two grids of a multigrid cycle, in single precision.
#pragma once

#include <vector>

#include "algebra/single_blocks.hpp"

namespace restshape {

// Interpolation from the next coarser grid.
struct GridTransfer {
    virtual ~GridTransfer() = default;
    virtual void set(const StoredRows& own, const StoredRows& coupling, const std::vector<PetscInt>& place) = 0;
    // coarse += P^T r, and ghosts += its part for other ranks' nodes.
    virtual void restrict_to(const double* r, double* coarse, double* ghosts) const = 0;
    // fine = P of both.
    virtual void prolong(const double* coarse, const double* ghosts, double* fine) const = 0;
};

template <int R, int C>
class BlockGridTransfer final : public GridTransfer {
 public:
    void set(const StoredRows& own, const StoredRows& coupling, const std::vector<PetscInt>& place) override {
        const auto all = [](PetscInt, PetscInt) { return true; };
        own_.set(
            own, own.rows / R, [](PetscInt column) { return column; }, all);
        coupling_.set(
            coupling, own.rows / R, [&](PetscInt column) { return place[column]; }, all);
    }
    void restrict_to(const double* r, double* coarse, double* ghosts) const override {
        for (PetscInt i = 0; i < own_.rows(); ++i) {
            double less[R];
            for (int d = 0; d < R; ++d) less[d] = -r[i * R + d];
            own_.take_from(i, less, coarse);
            coupling_.take_from(i, less, ghosts);
        }
    }
    void prolong(const double* coarse, const double* ghosts, double* fine) const override {
        for (PetscInt i = 0; i < own_.rows(); ++i) {
            ProductSum<R, C> sum = own_.times(i, coarse);
            const ProductSum<R, C> other = coupling_.times(i, ghosts);
            for (int d = 0; d < R; ++d) fine[i * R + d] = sum[d] + other[d];
        }
    }

 private:
    SingleBlocks<R, C> own_, coupling_;
};

}  // namespace restshape
