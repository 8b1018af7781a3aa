// The operator of one rank: CSR arrays of our own, which PETSc's matrix borrows.
#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "algebra/pair_product.hpp"
#include "fem/operator.hpp"

namespace restshape {

namespace {

struct Arrays {
    std::vector<PetscInt> row, column;
    std::vector<double> value;
};

PetscErrorCode release_arrays(void* context) {
    delete static_cast<std::shared_ptr<Arrays>*>(context);
    return 0;
}

}  // namespace

class CsrOperator final : public Operator {
 public:
    CsrOperator(bool world, int fields, std::vector<int32_t> node_offsets, int rank)
        : Operator(world, fields, std::move(node_offsets), rank) {
        if (node_offsets_.size() != 2) throw std::invalid_argument("backend csr is for one rank; use coo");
    }

    int64_t nonzeros() const override { return arrays_ ? static_cast<int64_t>(arrays_->column.size()) : 0; }

 protected:
    void new_pattern() override {
        graph_.build(nodes(), blocks_);
        auto fresh = idle_arrays();
        resize(*fresh);
        for (int i = 0; i < nodes(); ++i) write_rows(*fresh, i);
        use(std::move(fresh));
    }

    void patch_pattern(int block, const int32_t* changed, int count) override {
        const std::vector<int32_t>& grown = graph_.patch(blocks_, block, changed, count, old_start_);
        if (grown.empty()) return;
        auto fresh = idle_arrays();
        resize(*fresh);
        int from = 0;
        for (int32_t node : grown) {
            copy_rows(*fresh, from, node);
            write_rows(*fresh, node);
            from = node + 1;
        }
        copy_rows(*fresh, from, nodes());
        use(std::move(fresh));
    }

    Entries values() override { return {arrays_->value.data(), arrays_->value.size()}; }

    void assemble(int block, const Terms& terms) override {
        with_sizes(*terms.list.front().element, [&](auto sizes) { assemble(sizes, block, terms); });
    }

    void set_diagonal(int dof, double value) override {
        const int node = dof / fields_, component = dof % fields_;
        arrays_->value[arrays_->row[dof] + graph_.place(node, node) * fields_ + component] = value;
    }

    void finish() override {
        // Notifies PETSc that the values are new; the pattern and its inodes stay.
        double* values = nullptr;
        check(MatSeqAIJGetArrayWrite(mat(), &values), "MatSeqAIJGetArrayWrite");
        check(MatSeqAIJRestoreArrayWrite(mat(), &values), "MatSeqAIJRestoreArrayWrite");
    }

 private:
    template <class Sizes>
    void assemble(Sizes sizes, int block, const Terms& terms) {
        const int32_t* start = graph_.start.data();
        double* value = arrays_->value.data();
        const Block& b = blocks_[block];
        const int number = terms.subset ? terms.subset_count : b.count;
        element_loop(
            sizes, block, terms, terms.subset, number, [=, &b](int, int e, const int32_t* cell, const double* K) {
                const int count = sizes.dof_nodes(), fields = sizes.fields(), stride = sizes.stride();
                // Of nodes that touch nothing the memory need not be either.
                if (count == 1 && std::all_of(K, K + stride * fields, [](double entry) { return entry == 0.0; }))
                    return;
                const uint16_t* offset = b.offsets(e);
                for (int i = 0; i < count; ++i, offset += count) {
                    const int32_t first = start[cell[i]];
                    const int length = (start[cell[i] + 1] - first) * fields;
                    double* row = value + static_cast<size_t>(first) * fields * fields;
                    for (int a = 0; a < fields; ++a, row += length, K += stride)
                        for (int j = 0; j < count; ++j) {
                            using Values = Eigen::Array<double, Sizes::fixed_fields, 1>;
                            Eigen::Map<Values> target(row + offset[j] * fields, fields);
                            target += Eigen::Map<const Values>(K + j * fields, fields);
                        }
                }
            });
    }

    // Arrays that no matrix borrows any more, so that patches do not allocate.
    std::shared_ptr<Arrays> idle_arrays() {
        for (const auto& a : pool_)
            if (a.use_count() == 1) return a;
        pool_.push_back(std::make_shared<Arrays>());
        return pool_.back();
    }

    void resize(Arrays& a) const {
        const size_t f = fields_, entries = graph_.adjacent.size() * f * f;
        if (entries > static_cast<size_t>(std::numeric_limits<PetscInt>::max()))
            throw std::runtime_error("the matrix has more entries than PETSc's index type can count");
        if (a.column.capacity() < entries) {
            // Room for the pairs that flips bring.
            a.column.reserve(entries + entries / 16);
            a.value.reserve(entries + entries / 16);
        }
        a.row.resize(nodes() * f + 1);
        a.column.resize(entries);
        a.value.resize(entries);
        a.row[nodes() * f] = static_cast<PetscInt>(entries);
    }

    void write_rows(Arrays& a, int node) const {
        const int f = fields_, degree = graph_.degree(node), length = degree * f;
        const int32_t* neighbour = graph_.adjacent.data() + graph_.start[node];
        const size_t first = static_cast<size_t>(graph_.start[node]) * f * f;
        PetscInt* column = a.column.data() + first;
        for (int j = 0; j < degree; ++j)
            for (int c = 0; c < f; ++c) column[j * f + c] = static_cast<PetscInt>(neighbour[j]) * f + c;
        for (int k = 0; k < f; ++k) {
            if (k) std::copy(column, column + length, column + k * length);
            a.row[node * f + k] = static_cast<PetscInt>(first + k * length);
        }
    }

    // Rows of nodes from:to as they are in the arrays before the patch.
    void copy_rows(Arrays& a, int from, int to) const {
        if (from >= to) return;
        const size_t f = fields_, source = old_start_[from] * f * f, end = old_start_[to] * f * f;
        const size_t target = graph_.start[from] * f * f;
        std::memcpy(a.column.data() + target, arrays_->column.data() + source, (end - source) * sizeof(PetscInt));
        const PetscInt shift = static_cast<PetscInt>(target - source);
        for (size_t r = from * f; r < to * f; ++r) a.row[r] = arrays_->row[r] + shift;
    }

    // A matrix on these arrays, which live as long as it does: a solver may still hold it after the next patch.
    void use(std::shared_ptr<Arrays> fresh) {
        arrays_ = std::move(fresh);
        const PetscInt n = static_cast<PetscInt>(nodes()) * fields_;
        Mat mat = nullptr;
        check(MatCreateSeqAIJWithArrays(comm_, n, n, arrays_->row.data(), arrays_->column.data(), arrays_->value.data(),
                                        &mat),
              "MatCreateSeqAIJWithArrays");
        check(MatSetBlockSize(mat, fields_), "MatSetBlockSize");
        PetscContainer container = nullptr;
        check(PetscContainerCreate(comm_, &container), "PetscContainerCreate");
        check(PetscContainerSetPointer(container, new std::shared_ptr<Arrays>(arrays_)), "PetscContainerSetPointer");
        check(PetscContainerSetUserDestroy(container, release_arrays), "PetscContainerSetUserDestroy");
        check(PetscObjectCompose(reinterpret_cast<PetscObject>(mat), "restshape_arrays",
                                 reinterpret_cast<PetscObject>(container)),
              "PetscObjectCompose");
        check(PetscContainerDestroy(&container), "PetscContainerDestroy");
        if (fields_ == 2) check(multiply_by_pairs(mat), "MatSetOperation");
        replace_matrix(mat);
    }

    NodeGraph graph_;
    std::shared_ptr<Arrays> arrays_;
    std::vector<std::shared_ptr<Arrays>> pool_;
    std::vector<int32_t> old_start_;
};

std::unique_ptr<Operator> make_csr_operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank) {
    return std::make_unique<CsrOperator>(world, fields, std::move(node_offsets), rank);
}

}  // namespace restshape
