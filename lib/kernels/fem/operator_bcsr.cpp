// The operator of one rank in blocks of the unknowns of two nodes: products and relaxation read a ninth of the columns.
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "fem/operator.hpp"

namespace restshape {

class BcsrOperator final : public Operator {
 public:
    BcsrOperator(bool world, int fields, std::vector<int32_t> node_offsets, int rank)
        : Operator(world, fields, std::move(node_offsets), rank) {
        if (node_offsets_.size() != 2) throw std::invalid_argument("backend bcsr is for one rank; use csr");
    }

    int64_t nonzeros() const override { return static_cast<int64_t>(values_.count); }

 protected:
    void new_pattern() override {
        graph_.build(own_, blocks_);
        use_graph();
    }

    void patch_pattern(int block, const int32_t* changed, int count) override {
        if (!graph_.patch(blocks_, block, changed, count, old_start_).empty()) use_graph();
    }

    Entries values() override { return values_; }

    void assemble(int block, const Terms& terms) override {
        with_sizes(*terms.list.front().element, [&](auto sizes) { assemble(sizes, block, terms); });
    }

    void set_diagonal(int dof, double value) override {
        const int node = dof / fields_, component = dof % fields_;
        const size_t place = graph_.start[node] + graph_.place(node, node);
        values_.data[(place * fields_ + component) * fields_ + component] = value;
    }

    void finish() override {
        // Unlike access to the array, this makes PETSc forget the inverses of diagonal blocks.
        check(MatAssemblyBegin(mat(), MAT_FINAL_ASSEMBLY), "MatAssemblyBegin");
        check(MatAssemblyEnd(mat(), MAT_FINAL_ASSEMBLY), "MatAssemblyEnd");
    }

 private:
    template <class Sizes>
    void assemble(Sizes sizes, int block, const Terms& terms) {
        const int32_t* start = graph_.start.data();
        double* value = values_.data;
        const Block& b = blocks_[block];
        const bool symmetric =
            std::all_of(terms.list.begin(), terms.list.end(), [](const Term& term) { return term.element->symmetric; });
        element_loop(sizes, block, terms, [=, &b](int place, const int32_t* cell, const double* K) {
            const int count = sizes.dof_nodes(), fields = sizes.fields(), stride = sizes.stride();
            // Of nodes that touch nothing the memory need not be either.
            if (count == 1 && std::all_of(K, K + stride * fields, [](double entry) { return entry == 0.0; })) return;
            const uint16_t* offset = b.offsets(place);
            for (int i = 0; i < count; ++i, offset += count)
                for (int j = 0; j < count; ++j) {
                    constexpr int f = Sizes::fixed_fields;
                    using Part = Eigen::Matrix<double, f, f>;
                    double* target = value + static_cast<size_t>(start[cell[i]] + offset[j]) * fields * fields;
                    // PETSc's blocks go down their columns, which of a symmetric tangent are the rows of the other
                    // one.
                    const double* source = K + (symmetric ? j * stride + i : i * stride + j) * fields;
                    const Eigen::Map<const Part, 0, Eigen::OuterStride<>> part(source, fields, fields,
                                                                               Eigen::OuterStride<>(stride));
                    if (symmetric)
                        Eigen::Map<Part>(target, fields, fields) += part;
                    else
                        Eigen::Map<Part>(target, fields, fields) += part.transpose();
                }
        });
    }

    void use_graph() {
        const size_t entries = graph_.adjacent.size() * fields_ * fields_;
        if (entries > static_cast<size_t>(std::numeric_limits<PetscInt>::max()))
            throw std::runtime_error("the matrix has more entries than PETSc's index type can count");
        const std::vector<PetscInt> row(graph_.start.begin(), graph_.start.end());
        const std::vector<PetscInt> column(graph_.adjacent.begin(), graph_.adjacent.end());
        const PetscInt n = static_cast<PetscInt>(nodes()) * fields_;
        Mat mat = nullptr;
        check(MatCreate(comm_, &mat), "MatCreate");
        check(MatSetSizes(mat, n, n, n, n), "MatSetSizes");
        check(MatSetType(mat, MATSEQBAIJ), "MatSetType");
        check(MatSeqBAIJSetPreallocationCSR(mat, fields_, row.data(), column.data(), nullptr),
              "MatSeqBAIJSetPreallocationCSR");
        // PETSc borrows no blocks; theirs stay where they are as long as the pattern does.
        check(MatSeqBAIJGetArray(mat, &values_.data), "MatSeqBAIJGetArray");
        values_.count = entries;
        replace_matrix(mat);
    }

    NodeGraph graph_;
    Entries values_;
    std::vector<int32_t> old_start_;
};

std::unique_ptr<Operator> make_bcsr_operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank) {
    return std::make_unique<BcsrOperator>(world, fields, std::move(node_offsets), rank);
}

}  // namespace restshape
