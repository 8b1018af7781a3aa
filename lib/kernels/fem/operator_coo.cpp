// The operator of any number of ranks: PETSc's COO assembly of the elements that touch own nodes.
#include <algorithm>

#include "fem/operator.hpp"

namespace restshape {

class CooOperator final : public Operator {
 public:
    CooOperator(bool world, int fields, std::vector<int32_t> node_offsets, int rank)
        : Operator(world, fields, std::move(node_offsets), rank) {}

    int64_t nonzeros() const override {
        MatInfo info;
        check(MatGetInfo(mat(), MAT_LOCAL, &info), "MatGetInfo");
        return static_cast<int64_t>(info.nz_used);
    }

 protected:
    void new_pattern() override {
        touching_.assign(blocks_.size(), {});
        first_.assign(blocks_.size(), 0);
        size_t entries = 0;
        for (size_t k = 0; k < blocks_.size(); ++k) {
            const Block& b = blocks_[k];
            for (int e = 0; e < b.count; ++e)
                if (std::any_of(b.dofs_of(e), b.dofs_of(e) + b.dof_nodes, [this](int32_t i) { return owned(i); }))
                    touching_[k].push_back(e);
            first_[k] = entries;
            entries += touching_[k].size() * b.dof_nodes * b.dof_nodes * fields_ * fields_;
        }
        diagonal_first_ = entries;
        value_.assign(entries + static_cast<size_t>(own_nodes()) * fields_, 0.0);
        preallocate();
    }

    void patch_pattern(int, const int32_t*, int) override { new_pattern(); }

    Entries values() override { return {value_.data(), value_.size()}; }

    void assemble(int block, const Terms& terms) override {
        double* value = value_.data() + first_[block];
        const std::vector<int32_t>& list = touching_[block];
        const bool whole = !terms.subset;
        with_sizes(*terms.list.front().element, [&](auto sizes) {
            element_loop(sizes, block, terms, whole ? list.data() : terms.subset,
                         whole ? static_cast<int>(list.size()) : terms.subset_count,
                         [=, &list](int k, int e, const int32_t*, const double* K) {
                             // A subset may name cells that no own node is of.
                             const auto at = whole ? list.begin() + k : std::lower_bound(list.begin(), list.end(), e);
                             if (at == list.end() || *at != e) return;
                             const int n = sizes.dof_nodes() * sizes.fields(), stride = sizes.stride();
                             double* v = value + static_cast<size_t>(at - list.begin()) * n * n;
                             for (int i = 0; i < n; ++i)
                                 for (int j = 0; j < n; ++j) v[i * n + j] += K[i * stride + j];
                         });
        });
    }

    void set_diagonal(int dof, double value) override {
        value_[diagonal_first_ + dof - node_offsets_[rank_] * fields_] = value;
    }

    void finish() override { check(MatSetValuesCOO(mat(), value_.data(), INSERT_VALUES), "MatSetValuesCOO"); }

 private:
    void preallocate() {
        std::vector<PetscInt> rows, columns;
        rows.reserve(value_.size());
        columns.reserve(value_.size());
        for (size_t k = 0; k < blocks_.size(); ++k)
            for (int32_t e : touching_[k]) append(blocks_[k].dofs_of(e), blocks_[k].dof_nodes, rows, columns);
        // Every diagonal entry exists, also where no element is.
        for (int i = node_offsets_[rank_] * fields_; i < node_offsets_[rank_ + 1] * fields_; ++i) {
            rows.push_back(i);
            columns.push_back(i);
        }
        const PetscInt own = static_cast<PetscInt>(own_nodes()) * fields_,
                       all = static_cast<PetscInt>(nodes()) * fields_;
        Mat mat = nullptr;
        check(MatCreate(comm_, &mat), "MatCreate");
        check(MatSetSizes(mat, own, own, all, all), "MatSetSizes");
        check(MatSetType(mat, MATAIJ), "MatSetType");
        check(MatSetBlockSize(mat, fields_), "MatSetBlockSize");
        check(MatSetPreallocationCOO(mat, static_cast<PetscCount>(rows.size()), rows.data(), columns.data()),
              "MatSetPreallocationCOO");
        replace_matrix(mat);
    }

    // Row by row, as the element loop writes values; rows of other ranks are left out with -1.
    void append(const int32_t* cell, int count, std::vector<PetscInt>& rows, std::vector<PetscInt>& columns) const {
        for (int i = 0; i < count; ++i)
            for (int a = 0; a < fields_; ++a)
                for (int j = 0; j < count; ++j)
                    for (int c = 0; c < fields_; ++c) {
                        rows.push_back(owned(cell[i]) ? static_cast<PetscInt>(cell[i]) * fields_ + a : -1);
                        columns.push_back(static_cast<PetscInt>(cell[j]) * fields_ + c);
                    }
    }

    std::vector<std::vector<int32_t>> touching_;  // a block: elements with an own node
    std::vector<size_t> first_;                   // a block: its first entry in value_
    size_t diagonal_first_ = 0;
    std::vector<double> value_;
};

std::unique_ptr<Operator> make_coo_operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank) {
    return std::make_unique<CooOperator>(world, fields, std::move(node_offsets), rank);
}

}  // namespace restshape
