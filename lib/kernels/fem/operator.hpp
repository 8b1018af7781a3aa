// A sparse matrix assembled from elements, with supports eliminated inside the elements. Its backends share the loop.
#pragma once

#include <petscmat.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/pattern.hpp"

namespace restshape {

static_assert(sizeof(PetscScalar) == sizeof(double), "restshape needs a PETSc of real double precision");

// Throws std::runtime_error with PETSc's message.
void check(PetscErrorCode code, const char* call);

// One element of a sum: matrix += coef * tangent, rhs -= residual_coef * residual.
struct Term {
    const Element* element;
    const double *x, *coefficients, *parameters;  // coefficients are null where the element has none
    int parameter_stride;                         // 0: the same for all elements
    double coef, residual_coef;
};

// What `add` assembles on the cells of a block, each scattered once for all terms (rhs may be null). Of a subset of
// them, in which cells may stand more than once, parameters have a row for each entry of it, or the one that is named.
struct Terms {
    const double* X;
    double* rhs;
    std::vector<Term> list;
    const int32_t *subset = nullptr, *parameter_rows = nullptr;
    int subset_count = 0;

    int parameter_row(int k, int e) const { return !subset ? e : parameter_rows ? parameter_rows[k] : k; }
};

// Stored entries of a matrix.
struct Entries {
    double* data = nullptr;
    size_t count = 0;
};

class Operator {
 public:
    static std::unique_ptr<Operator> create(bool world, int fields, std::vector<int32_t> node_offsets, int rank,
                                            const std::string& backend);
    virtual ~Operator();
    Operator(const Operator&) = delete;
    Operator& operator=(const Operator&) = delete;

    void set_topology(std::vector<Block> blocks);
    void patch(int block, const int32_t* changed, int count);
    void set_constraints(const uint8_t* mask);
    void set_sliding(const int32_t* list, int count, const double* kept);
    void begin(bool kept);
    void keep();
    void add(int block, const Terms& terms);
    void end();

    Mat mat() const;
    int64_t generation() const { return generation_; }
    virtual int64_t nonzeros() const = 0;
    int fields() const { return fields_; }
    int nodes() const { return node_offsets_.back(); }
    static const std::set<const Operator*>& living();  // all that exist
    int block_count() const { return static_cast<int>(blocks_.size()); }
    const Block& block(int k) const;

 protected:
    Operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank);

    virtual void new_pattern() = 0;
    virtual void patch_pattern(int block, const int32_t* changed, int count) = 0;
    virtual Entries values() = 0;  // that `assemble` adds to
    virtual void assemble(int block, const Terms& terms) = 0;
    virtual void set_diagonal(int dof, double value) = 0;
    virtual void finish() = 0;

    // Takes the matrix over and retires the one before.
    void replace_matrix(Mat mat);
    bool owned(int32_t node) const { return own_.has(node); }

    // Calls scatter(place of e in the block's list, dofs, K) with the constrained sum of the tangents of each cell e
    // that touches an own node, or of those of the subset.
    template <class Sizes, class Scatter>
    void element_loop(Sizes sizes, int block, const Terms& terms, Scatter scatter);

    // The same where all terms have a pass of several elements at once.
    static bool packs(const Terms& terms);
    template <class Sizes, class Scatter>
    void packed_loop(Sizes sizes, int block, const Terms& terms, Scatter scatter);

    MPI_Comm comm_;
    int fields_, rank_;
    std::vector<int32_t> node_offsets_;
    NodeRange own_;
    std::vector<Block> blocks_;

 private:
    void check_cells(const Block& block, const int32_t* list, int count) const;
    static void find_geometry_end(Block& block, const int32_t* list, int count);
    void flag_constrained(int block, const int32_t* list, int count);
    void flag_all_constrained();
    void subtract(const int32_t* dofs, int dof_nodes, int fields, double coef, const double* r, double* rhs) const {
        for (int i = 0; i < dof_nodes; ++i)
            if (owned(dofs[i]))
                for (int a = 0; a < fields; ++a)
                    rhs[static_cast<size_t>(dofs[i]) * fields + a] -= coef * r[i * fields + a];
    }
    void release_retired();
    void stop_filling();
    void constrain(const Element& element, const int32_t* dofs, double coef, double* r, double* K);
    void slide(const Element& element, int node, const double* kept, double coef, double* r, double* K) const;

    Mat mat_ = nullptr;
    std::vector<Mat> retired_;
    int64_t generation_ = 0;
    bool filling_ = false;
    std::vector<uint8_t> mask_;                  // (nodes * fields), 1 where constrained
    std::vector<int32_t> sliding_;               // nodes whose first two unknowns are projected
    std::vector<int32_t> slide_of_;              // (nodes), index among those, or -1; empty without any
    std::vector<double> slides_;                 // xx, xy, yy of each projection
    std::vector<int32_t> constrained_;           // own constrained unknowns
    std::vector<double> diagonal_;               // (nodes * fields), what constrained diagonals have got
    bool keeps_ = false;                         // what `keep` has noted, which a rank without nodes has none of
    std::vector<double> kept_, kept_diagonal_;   // its values and diagonal_
    std::vector<std::vector<uint8_t>> flagged_;  // a block: elements with a constrained unknown
};

// Sizes of an element, known to the compiler where they are not 0.
template <int Nodes, int Dim, int Fields>
struct Sizes {
    static constexpr int fixed_fields = Fields ? Fields : Eigen::Dynamic;
    // Whether an element of that size may have a pass of several elements at once.
    static constexpr bool packs = Nodes > 0 && Nodes* Dim <= max_packed&& Nodes* Fields <= max_packed;
    int nodes_, dim_, dof_nodes_, fields_;

    explicit Sizes(const Element& e) : nodes_(e.nodes), dim_(e.dim), dof_nodes_(e.dof_nodes), fields_(e.fields) {}
    int nodes() const { return Nodes ? Nodes : nodes_; }
    int dof_nodes() const { return Nodes ? Nodes : dof_nodes_; }
    int dim() const { return Dim ? Dim : dim_; }
    int fields() const { return Fields ? Fields : fields_; }
    int stride() const { return padded_lanes(dof_nodes() * fields()); }  // of an element's tangent
};

// Runs the same loop with its inner counts unrolled for the commonest sizes.
template <class Run>
void with_sizes(const Element& e, Run run) {
    const auto is = [&e](int nodes, int dim, int fields) {
        return e.nodes == nodes && e.dof_nodes == nodes && e.dim == dim && e.fields == fields;
    };
    if (is(1, 2, 3)) return run(Sizes<1, 2, 3>(e));
    if (is(3, 2, 1)) return run(Sizes<3, 2, 1>(e));
    if (is(6, 2, 1)) return run(Sizes<6, 2, 1>(e));
    if (is(3, 2, 2)) return run(Sizes<3, 2, 2>(e));
    if (is(6, 2, 2)) return run(Sizes<6, 2, 2>(e));
    if (is(3, 2, 3)) return run(Sizes<3, 2, 3>(e));
    if (is(3, 2, 4)) return run(Sizes<3, 2, 4>(e));
    if (is(4, 2, 3)) return run(Sizes<4, 2, 3>(e));
    if (is(6, 2, 3)) return run(Sizes<6, 2, 3>(e));
    if (is(3, 3, 3)) return run(Sizes<3, 3, 3>(e));
    if (is(4, 3, 3)) return run(Sizes<4, 3, 3>(e));
    if (is(10, 3, 3)) return run(Sizes<10, 3, 3>(e));
    run(Sizes<0, 0, 0>(e));
}

// Own memory in PETSc's CSR format: new values and patches cost no search, no preallocation and no message of values.
std::unique_ptr<Operator> make_csr_operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank);
// The same in blocks of two nodes (PETSc's BAIJ), one rank, which products and relaxation read faster.
std::unique_ptr<Operator> make_bcsr_operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank);

// GCC does not see that `sum` is read only where it has been filled.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

template <class Sizes, class Scatter>
void Operator::element_loop(Sizes sizes, int block, const Terms& terms, Scatter scatter) {
    if constexpr (Sizes::packs)
        if (!terms.subset && packs(terms)) return packed_loop(sizes, block, terms, scatter);
    alignas(64) double X[max_coordinates], x[max_unknowns], r[max_unknowns], K[max_tangent], sum[max_tangent];
    alignas(64) double w[max_coefficients];
    const Block& b = blocks_[block];
    const uint8_t* flagged = flagged_[block].data();
    const int nodes = sizes.nodes(), dim = sizes.dim(), dof_nodes = sizes.dof_nodes(), fields = sizes.fields();
    const int entries = dof_nodes * fields * sizes.stride();
    const int count = terms.subset ? terms.subset_count : b.listed();
    for (int k = 0; k < count; ++k) {
        const int e = terms.subset ? terms.subset[k] : b.element(k);
        const int place = terms.subset ? b.position(e) : k;
        const int32_t *cell = b.nodes_of(e), *dofs = b.dofs_of(e);
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < dim; ++a) X[i * dim + a] = terms.X[static_cast<size_t>(cell[i]) * dim + a];
        bool filled = false;
        for (const Term& t : terms.list) {
            for (int i = 0; i < dof_nodes; ++i)
                for (int a = 0; a < fields; ++a) x[i * fields + a] = t.x[static_cast<size_t>(dofs[i]) * fields + a];
            if (t.coefficients) gather(cell, nodes, t.element->coefficient_count(), t.coefficients, w);
            const double* p = t.parameters + static_cast<size_t>(terms.parameter_row(k, e)) * t.parameter_stride;
            const bool tangent = t.element->has_tangent();
            if (tangent)
                t.element->residual_tangent(X, x, w, p, r, K);
            else
                t.element->residual(X, x, w, p, r);
            if (flagged[e]) constrain(*t.element, dofs, t.coef, r, K);
            if (terms.rhs) subtract(dofs, dof_nodes, fields, t.residual_coef, r, terms.rhs);
            if (!tangent) continue;
            if (terms.list.size() == 1 && t.coef == 1.0) {
                scatter(place, dofs, K);
                continue;
            }
            if (filled)
                for (int q = 0; q < entries; ++q) sum[q] += t.coef * K[q];
            else
                for (int q = 0; q < entries; ++q) sum[q] = t.coef * K[q];
            filled = true;
        }
        if (filled) scatter(place, dofs, sum);
    }
}

template <class Sizes, class Scatter>
void Operator::packed_loop(Sizes sizes, int block, const Terms& terms, Scatter scatter) {
    const Block& b = blocks_[block];
    const int count = b.listed();
    const int nodes = sizes.nodes(), dim = sizes.dim(), dof_nodes = sizes.dof_nodes(), fields = sizes.fields();
    const int n = dof_nodes * fields, term_count = static_cast<int>(terms.list.size());
    Pack X[max_packed], x[max_packed], w[max_coefficients], p[max_packed_terms][max_parameters], r[max_packed];
    Pack K[max_packed * max_packed], force[max_packed], sum[max_packed * max_packed];
    double own[max_coefficients];
    // Element by element, a row in packs.
    constexpr int padded = padded_lanes(max_packed);
    alignas(64) double Ke[pack_lanes][max_packed * padded], re[pack_lanes][padded];
    for (int first = 0; first < count; first += pack_lanes) {
        const int filled = std::min(pack_lanes, count - first);
        int cells[pack_lanes];
        const int32_t *node[pack_lanes], *dof[pack_lanes];
        // Lanes beyond the last element repeat it.
        for (int lane = 0; lane < pack_lanes; ++lane) {
            cells[lane] = b.element(first + std::min(lane, filled - 1));
            node[lane] = b.nodes_of(cells[lane]), dof[lane] = b.dofs_of(cells[lane]);
        }
        gather(node, nodes, dim, terms.X, X);
        for (int q = 0; q < term_count; ++q) {
            const Term& t = terms.list[q];
            const int parameters = static_cast<int>(t.element->parameters.size());
            const int coefficients = t.element->coefficient_count();
            gather(dof, dof_nodes, fields, t.x, x);
            for (int lane = 0; lane < pack_lanes; ++lane) {
                const int e = cells[lane];
                if (coefficients) {
                    gather(node[lane], nodes, coefficients, t.coefficients, own);
                    set_lane(w, lane, own, nodes * coefficients);
                }
                if (t.parameter_stride || !first)
                    set_lane(p[q], lane, t.parameters + static_cast<size_t>(e) * t.parameter_stride, parameters);
            }
            t.element->packed.tangent(X, x, w, p[q], q ? r : force, q ? K : sum);
            if (q == 0) {
                if (t.residual_coef != 1.0)
                    for (int i = 0; i < n; ++i) force[i] *= t.residual_coef;
                if (t.coef != 1.0)
                    for (int i = 0; i < n * n; ++i) sum[i] *= t.coef;
                continue;
            }
            for (int i = 0; i < n; ++i) force[i] += t.residual_coef * r[i];
            for (int i = 0; i < n * n; ++i) sum[i] += t.coef * K[i];
        }
        for (int i = 0; i < n; ++i) spread(sum + i * n, n, Ke[0] + i * sizes.stride(), max_packed * padded);
        spread(force, n, re[0], padded);
        for (int lane = 0; lane < filled; ++lane) {
            if (flagged_[block][cells[lane]])
                constrain(*terms.list.front().element, dof[lane], 1.0, re[lane], Ke[lane]);
            if (terms.rhs) subtract(dof[lane], dof_nodes, fields, 1.0, re[lane], terms.rhs);
            scatter(first + lane, dof[lane], Ke[lane]);
        }
    }
}

#pragma GCC diagnostic pop

}  // namespace restshape
