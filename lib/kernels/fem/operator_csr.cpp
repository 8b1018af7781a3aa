// The operator in CSR arrays of our own, which PETSc's matrix borrows. On several ranks each has the rows of its own
// nodes, their columns of own nodes apart from those of other ranks' nodes, as PETSc keeps them; nothing is sent for
// values.
#include <petsc/private/petscimpl.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "algebra/pair_product.hpp"
#include "fem/operator.hpp"

namespace restshape {

namespace {

// Rows in columns of own nodes, and in those of other ranks' nodes. PETSc numbers the latter anew in place.
struct Arrays {
    std::vector<PetscInt> row, column, ghost_row, ghost_column;
    std::vector<double> value;  // those of `column`, then those of `ghost_column`
};

PetscErrorCode release_arrays(void* context) {
    delete static_cast<std::shared_ptr<Arrays>*>(context);
    return 0;
}

void announce_values(Mat mat) {
    double* values = nullptr;
    check(MatSeqAIJGetArrayWrite(mat, &values), "MatSeqAIJGetArrayWrite");
    check(MatSeqAIJRestoreArrayWrite(mat, &values), "MatSeqAIJRestoreArrayWrite");
}

}  // namespace

class CsrOperator final : public Operator {
 public:
    CsrOperator(bool world, int fields, std::vector<int32_t> node_offsets, int rank)
        : Operator(world, fields, std::move(node_offsets), rank), alone_(node_offsets_.size() == 2) {}

    int64_t nonzeros() const override { return arrays_ ? static_cast<int64_t>(arrays_->value.size()) : 0; }

 protected:
    void new_pattern() override {
        graph_.build(own_, blocks_);
        part_rows();
        auto fresh = idle_arrays();
        resize(*fresh);
        for (int i = 0; i < own_.count; ++i) write_rows(*fresh, i);
        use(std::move(fresh));
    }

    void patch_pattern(int block, const int32_t* changed, int count) override {
        const std::vector<int32_t>& grown = graph_.patch(blocks_, block, changed, count, old_start_);
        if (!grown_anywhere(!grown.empty())) return;
        auto fresh = idle_arrays();
        if (!grown.empty()) {
            old_own_start_.swap(own_start_);
            part_rows();
        } else if (!alone_) {
            old_own_start_ = own_start_;
        }
        resize(*fresh);
        int from = 0;
        for (int32_t row : grown) {
            copy_rows(*fresh, from, row);
            write_rows(*fresh, row);
            from = row + 1;
        }
        copy_rows(*fresh, from, own_.count);
        use(std::move(fresh));
    }

    Entries values() override { return {arrays_->value.data(), arrays_->value.size()}; }

    void assemble(int block, const Terms& terms) override {
        with_sizes(*terms.list.front().element, [&](auto sizes) { assemble(sizes, block, terms); });
    }

    void set_diagonal(int dof, double value) override {
        const int row = dof / fields_ - own_.first, component = dof % fields_;
        arrays_->value[arrays_->row[row * fields_ + component] + graph_.place(row, row) * fields_ + component] = value;
    }

    void finish() override {
        // Notifies PETSc that the values are new; the pattern and its inodes stay.
        if (alone_) return announce_values(mat());
        Mat own = nullptr, ghosts = nullptr;
        check(MatMPIAIJGetSeqAIJ(mat(), &own, &ghosts, nullptr), "MatMPIAIJGetSeqAIJ");
        announce_values(own);
        announce_values(ghosts);
        check(PetscObjectStateIncrease(reinterpret_cast<PetscObject>(mat())), "PetscObjectStateIncrease");
    }

 private:
    template <class Sizes>
    void assemble(Sizes sizes, int block, const Terms& terms) {
        const int32_t *start = own_starts(), *ghost_start = alone_ ? nullptr : ghost_start_.data();
        double *value = arrays_->value.data(), *ghost_value = value + arrays_->column.size();
        const Block& b = blocks_[block];
        const NodeRange own = own_;
        element_loop(sizes, block, terms, [=, &b](int place, const int32_t* cell, const double* K) {
            const int count = sizes.dof_nodes(), fields = sizes.fields(), stride = sizes.stride();
            using Values = Eigen::Array<double, Sizes::fixed_fields, 1>;
            // Of nodes that touch nothing the memory need not be either.
            if (count == 1 && std::all_of(K, K + stride * fields, [](double entry) { return entry == 0.0; })) return;
            const uint16_t* offset = b.offsets(place);
            for (int i = 0; i < count; ++i, offset += count, K += fields * stride) {
                if (!own.has(cell[i])) continue;
                const int32_t node = cell[i] - own.first, first = start[node], degree = start[node + 1] - first;
                const int ghosts = ghost_start ? ghost_start[node + 1] - ghost_start[node] : 0;
                double* row = value + static_cast<size_t>(first) * fields * fields;
                const double* from = K;
                if (ghosts == 0) {
                    for (int a = 0; a < fields; ++a, row += degree * fields, from += stride)
                        for (int j = 0; j < count; ++j) {
                            Eigen::Map<Values> target(row + offset[j] * fields, fields);
                            target += Eigen::Map<const Values>(from + j * fields, fields);
                        }
                    continue;
                }
                double* ghost_row = ghost_value + static_cast<size_t>(ghost_start[node]) * fields * fields;
                for (int a = 0; a < fields; ++a, row += degree * fields, ghost_row += ghosts * fields, from += stride)
                    for (int j = 0; j < count; ++j) {
                        double* at =
                            offset[j] < degree ? row + offset[j] * fields : ghost_row + (offset[j] - degree) * fields;
                        Eigen::Map<Values> target(at, fields);
                        target += Eigen::Map<const Values>(from + j * fields, fields);
                    }
            }
        });
    }

    // Where rows of own nodes' columns start, counted in nodes.
    const int32_t* own_starts() const { return alone_ ? graph_.start.data() : own_start_.data(); }
    const int32_t* old_own_starts() const { return alone_ ? old_start_.data() : old_own_start_.data(); }

    // Whether a row has grown on any rank: all make a new matrix then.
    bool grown_anywhere(bool here) const {
        if (alone_) return here;
        int any = here;
        MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm_);
        return any != 0;
    }

    // Counts each row's columns of own nodes and of others.
    void part_rows() {
        if (alone_) return;
        own_start_.resize(own_.count + 1);
        ghost_start_.resize(own_.count + 1);
        own_start_[0] = ghost_start_[0] = 0;
        for (int i = 0; i < own_.count; ++i) {
            const int inside = graph_.own_degree(i);
            own_start_[i + 1] = own_start_[i] + inside;
            ghost_start_[i + 1] = ghost_start_[i] + graph_.degree(i) - inside;
        }
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
        const size_t own = static_cast<size_t>(own_starts()[own_.count]) * f * f;
        if (a.value.capacity() < entries) {
            // Room for the pairs that flips bring.
            a.column.reserve(own + own / 16);
            a.value.reserve(entries + entries / 16);
        }
        a.row.resize(own_.count * f + 1);
        a.column.resize(own);
        a.value.resize(entries);
        a.row[own_.count * f] = static_cast<PetscInt>(own);
        if (!alone_) write_ghost_rows(a);
    }

    void write_rows(Arrays& a, int node) const {
        const int f = fields_, degree = own_starts()[node + 1] - own_starts()[node], length = degree * f;
        const int32_t* neighbour = graph_.adjacent.data() + graph_.start[node];
        const size_t first = static_cast<size_t>(own_starts()[node]) * f * f;
        PetscInt* column = a.column.data() + first;
        for (int j = 0; j < degree; ++j)
            for (int c = 0; c < f; ++c) column[j * f + c] = static_cast<PetscInt>(neighbour[j]) * f + c;
        for (int k = 0; k < f; ++k) {
            if (k) std::copy(column, column + length, column + k * length);
            a.row[node * f + k] = static_cast<PetscInt>(first + k * length);
        }
    }

    // Few rows have columns of other ranks' nodes: these are always written anew.
    void write_ghost_rows(Arrays& a) const {
        const int f = fields_;
        a.ghost_row.resize(static_cast<size_t>(own_.count) * f + 1);
        a.ghost_column.resize(static_cast<size_t>(ghost_start_[own_.count]) * f * f);
        PetscInt* column = a.ghost_column.data();
        a.ghost_row[0] = 0;
        for (int i = 0; i < own_.count; ++i) {
            const int ghosts = ghost_start_[i + 1] - ghost_start_[i];
            const int32_t* neighbour = graph_.adjacent.data() + graph_.start[i + 1] - ghosts;
            for (int k = 0; k < f; ++k) {
                for (int j = 0; j < ghosts; ++j)
                    for (int c = 0; c < f; ++c) *column++ = static_cast<PetscInt>(own_.node_of(neighbour[j])) * f + c;
                a.ghost_row[static_cast<size_t>(i) * f + k + 1] = static_cast<PetscInt>(column - a.ghost_column.data());
            }
        }
    }

    // Rows of own nodes from:to as they are in the arrays before the patch.
    void copy_rows(Arrays& a, int from, int to) const {
        if (from >= to) return;
        const size_t f = fields_, source = old_own_starts()[from] * f * f, end = old_own_starts()[to] * f * f;
        const size_t target = own_starts()[from] * f * f;
        std::memcpy(a.column.data() + target, arrays_->column.data() + source, (end - source) * sizeof(PetscInt));
        const PetscInt shift = static_cast<PetscInt>(target) - static_cast<PetscInt>(source);
        for (size_t r = from * f; r < to * f; ++r) a.row[r] = arrays_->row[r] + shift;
    }

    // A matrix on these arrays, which live as long as it does: a solver may still hold it after the next patch.
    void use(std::shared_ptr<Arrays> fresh) {
        arrays_ = std::move(fresh);
        replace_matrix(alone_ ? matrix_of_one_rank() : matrix_of_ranks());
    }

    // Has arrays live as long as a matrix that borrows them.
    void hold_arrays(Mat mat) const {
        PetscContainer container = nullptr;
        check(PetscContainerCreate(PETSC_COMM_SELF, &container), "PetscContainerCreate");
        check(PetscContainerSetPointer(container, new std::shared_ptr<Arrays>(arrays_)), "PetscContainerSetPointer");
        check(PetscContainerSetUserDestroy(container, release_arrays), "PetscContainerSetUserDestroy");
        check(PetscObjectCompose(reinterpret_cast<PetscObject>(mat), "restshape_arrays",
                                 reinterpret_cast<PetscObject>(container)),
              "PetscObjectCompose");
        check(PetscContainerDestroy(&container), "PetscContainerDestroy");
    }

    Mat matrix_of_one_rank() {
        const PetscInt n = static_cast<PetscInt>(own_.count) * fields_;
        Mat mat = nullptr;
        check(MatCreateSeqAIJWithArrays(comm_, n, n, arrays_->row.data(), arrays_->column.data(), arrays_->value.data(),
                                        &mat),
              "MatCreateSeqAIJWithArrays");
        check(MatSetBlockSize(mat, fields_), "MatSetBlockSize");
        if (fields_ == 2) check(multiply_by_pairs(mat), "MatSetOperation");
        hold_arrays(mat);
        return mat;
    }

    Mat matrix_of_ranks() {
        const PetscInt own = static_cast<PetscInt>(own_.count) * fields_,
                       all = static_cast<PetscInt>(own_.all) * fields_;
        Arrays& a = *arrays_;
        Mat mat = nullptr, inside = nullptr, ghosts = nullptr;
        check(MatCreateMPIAIJWithSplitArrays(comm_, own, own, all, all, a.row.data(), a.column.data(), a.value.data(),
                                             a.ghost_row.data(), a.ghost_column.data(),
                                             a.value.data() + a.column.size(), &mat),
              "MatCreateMPIAIJWithSplitArrays");
        check(MatMPIAIJGetSeqAIJ(mat, &inside, &ghosts, nullptr), "MatMPIAIJGetSeqAIJ");
        check(MatSetBlockSize(mat, fields_), "MatSetBlockSize");
        check(MatSetBlockSize(inside, fields_), "MatSetBlockSize");
        if (fields_ == 2) check(multiply_by_pairs(inside), "MatSetOperation");
        // Solvers hold the parts alone, too.
        hold_arrays(inside);
        hold_arrays(ghosts);
        return mat;
    }

    const bool alone_;
    NodeGraph graph_;
    std::shared_ptr<Arrays> arrays_;
    std::vector<std::shared_ptr<Arrays>> pool_;
    std::vector<int32_t> old_start_;
    std::vector<int32_t> own_start_, ghost_start_, old_own_start_;  // on several ranks
};

std::unique_ptr<Operator> make_csr_operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank) {
    return std::make_unique<CsrOperator>(world, fields, std::move(node_offsets), rank);
}

}  // namespace restshape
