// Bindings of substitutions in panels, which take the place of PETSc's own in a factor of its.
#include <petscmat.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "algebra/node_cholesky.hpp"
#include "algebra/panels.hpp"
#include "fem/operator.hpp"

namespace py = pybind11;
using restshape::check;

namespace {

constexpr const char* key = "restshape_panels";
// Panels double the memory of a factor: 200 MB beside one with 2^24 entries.
constexpr size_t most_double = 1 << 24, most_single = 1 << 27;

using Rows = restshape::FactorRows<PetscInt>;
using Solve = PetscErrorCode (*)(Mat, Vec, Vec);

// Panels of numbers in double or single precision.
struct Panels : restshape::Substitution {
    virtual void set(const double* values) = 0;
    virtual double flops() const = 0;

    bool single = false;
    Solve own = nullptr;          // PETSc's
    std::vector<PetscInt> order;  // the row of the factor of each unknown
};

template <class Value>
struct PanelsOf final : Panels {
    explicit PanelsOf(const Rows& rows) : factor(rows) { single = sizeof(Value) < sizeof(double); }
    void set(const double* values) override { factor.set(values); }
    void solve(const double* b, double* x) override { factor.solve(b, order.data(), x); }
    void forward(const double* b, double* x) override { factor.forward_half(b, x); }
    void backward(const double* b, double* x) override { factor.backward_half(b, x); }
    double flops() const override { return 4.0 * static_cast<double>(factor.entries()) - 3.0 * factor.size(); }

    restshape::PanelFactor<PetscInt, Value> factor;
};

using Shared = std::shared_ptr<Panels>;

PetscErrorCode release(void* context) {
    delete static_cast<Shared*>(context);
    return 0;
}

// The panels that a factor goes by; none yet, or none that PETSc's own substitutions agree with.
Shared panels_of(Mat mat) {
    PetscObject container = nullptr;
    void* context = nullptr;
    check(PetscObjectQuery(reinterpret_cast<PetscObject>(mat), key, &container), "PetscObjectQuery");
    if (!container) return nullptr;
    check(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context), "PetscContainerGetPointer");
    return *static_cast<Shared*>(context);
}

// What MatSolve calls.
PetscErrorCode solve(Mat mat, Vec b, Vec x) {
    PetscObject container = nullptr;
    void* context = nullptr;
    PetscCall(PetscObjectQuery(reinterpret_cast<PetscObject>(mat), key, &container));
    PetscCall(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context));
    Panels& panels = **static_cast<Shared*>(context);
    const double* right = nullptr;
    double* left = nullptr;
    PetscCall(VecGetArrayRead(b, &right));
    PetscCall(VecGetArrayWrite(x, &left));
    panels.solve(right, left);
    PetscCall(VecRestoreArrayWrite(x, &left));
    PetscCall(VecRestoreArrayRead(b, &right));
    return PetscLogFlops(panels.flops());
}

// Limits of what is copied.
bool fits(const Rows& rows, bool single) { return rows.values() <= (single ? most_single : most_double); }

// Rows in panels; null where these are no rows of a complete factor.
template <class Value>
Shared panels_of_rows(const Rows& rows, const double* values) {
    Shared found;
    try {
        found = std::make_shared<PanelsOf<Value>>(rows);
    } catch (const std::invalid_argument&) {
        return nullptr;
    }
    found->order.resize(static_cast<std::size_t>(rows.count) * rows.size);
    std::iota(found->order.begin(), found->order.end(), 0);
    found->set(values);
    return found;
}

// A factor of node_blocks, in elimination order.
class BlocksFactor {
 public:
    explicit BlocksFactor(Mat mat) : mat_(mat) {
        const restshape::BlockRows own = restshape::factor_rows(mat);
        rows_ = {own.count, static_cast<int>(restshape::factor_block_size(mat)), own.start, own.column, false};
        values_ = own.value;
    }
    bool known(bool single) const { return values_ && fits(rows_, single); }
    const double* values() const { return values_; }
    PetscInt unknowns() const { return rows_.count * rows_.size; }

    template <class Value>
    Shared panels() const {
        return panels_of_rows<Value>(rows_, values_);
    }
    std::vector<double> substituted(std::vector<double> right) const {
        restshape::substitute_in_place(mat_, right.data());
        return right;
    }

 private:
    Mat mat_;
    Rows rows_{};
    const double* values_;
};

// A factor of PETSc's in symmetric blocks, seen through what it lets everybody see.
class PetscFactor {
 public:
    explicit PetscFactor(Mat mat) : mat_(mat) {
        PetscInt size = 0;
        check(MatGetBlockSize(mat_, &size), "MatGetBlockSize");
        rows_.size = static_cast<int>(size);
        rows_.pivot_last = size == 1;
        blocks_ = size > 1 ? PETSC_TRUE : PETSC_FALSE;
        check(MatGetRowIJ(mat_, 0, PETSC_FALSE, blocks_, &rows_.count, &rows_.start, &rows_.column, &done_),
              "MatGetRowIJ");
        check(MatSeqSBAIJGetArray(mat_, &values_), "MatSeqSBAIJGetArray");
        void (*own)(void) = nullptr;
        check(MatGetOperation(mat_, MATOP_SOLVE, &own), "MatGetOperation");
        own_ = reinterpret_cast<Solve>(own);
        if (own_ == solve) own_ = panels_of(mat_)->own;
    }
    ~PetscFactor() {
        (void)MatSeqSBAIJRestoreArray(mat_, &values_);
        (void)MatRestoreRowIJ(mat_, 0, PETSC_FALSE, blocks_, &rows_.count, &rows_.start, &rows_.column, &done_);
    }
    PetscFactor(const PetscFactor&) = delete;
    PetscFactor& operator=(const PetscFactor&) = delete;

    bool known(bool single) const { return done_ && own_ && fits(rows_, single); }
    const double* values() const { return values_; }

    PetscInt unknowns() const { return rows_.count * rows_.size; }

    // Null too where the rows are in no order of its unknowns.
    template <class Value>
    Shared panels() const {
        const Shared found = panels_of_rows<Value>(rows_, values_);
        if (!found) return nullptr;
        found->order = order();
        if (found->order.empty() && unknowns()) return nullptr;
        found->own = own_;
        return found;
    }

    // By PETSc itself, past its log: it is no solve of anybody's.
    std::vector<double> substituted(const std::vector<double>& right) const {
        const PetscInt n = unknowns();
        std::vector<double> found(n);
        Vec b = nullptr, x = nullptr;
        check(VecCreateSeqWithArray(PETSC_COMM_SELF, rows_.size, n, right.data(), &b), "VecCreateSeqWithArray");
        check(VecCreateSeqWithArray(PETSC_COMM_SELF, rows_.size, n, found.data(), &x), "VecCreateSeqWithArray");
        const PetscErrorCode code = own_(mat_, b, x);
        check(VecDestroy(&b), "VecDestroy");
        check(VecDestroy(&x), "VecDestroy");
        check(code, "MatSolve");
        return found;
    }

 private:
    // The row of each unknown; empty where that is no order. Without entries beside the diagonal, and there the rows'
    // own numbers, a substitution gives each unknown the number of its row.
    std::vector<PetscInt> order() const {
        const PetscInt n = unknowns();
        const std::vector<double> kept(values_, values_ + rows_.values()), ones(n, 1.0);
        std::fill(values_, values_ + rows_.values(), 0.0);
        for (PetscInt k = 0; k < rows_.count; ++k)
            for (int r = 0; r < rows_.size; ++r) values_[rows_.pivot(k, r)] = static_cast<double>(k * rows_.size + r);
        std::vector<double> row;
        try {
            row = substituted(ones);
        } catch (...) {
            std::copy(kept.begin(), kept.end(), values_);
            throw;
        }
        std::copy(kept.begin(), kept.end(), values_);
        std::vector<char> seen(n, 0);
        std::vector<PetscInt> found(n);
        for (PetscInt k = 0; k < n; ++k) {
            const double i = row[k];
            if (!(i >= 0.0 && i < n && i == std::floor(i)) || seen[static_cast<PetscInt>(i)]++) return {};
            found[static_cast<PetscInt>(i)] = k;
        }
        return found;
    }

    Mat mat_;
    Rows rows_{};
    PetscBool blocks_ = PETSC_FALSE, done_ = PETSC_FALSE;
    double* values_ = nullptr;
    Solve own_ = nullptr;
};

void compose(Mat mat, const Shared& panels) {
    PetscContainer container = nullptr;
    check(PetscContainerCreate(PETSC_COMM_SELF, &container), "PetscContainerCreate");
    check(PetscContainerSetPointer(container, new Shared(panels)), "PetscContainerSetPointer");
    check(PetscContainerSetUserDestroy(container, release), "PetscContainerSetUserDestroy");
    check(PetscObjectCompose(reinterpret_cast<PetscObject>(mat), key, reinterpret_cast<PetscObject>(container)),
          "PetscObjectCompose");
    check(PetscContainerDestroy(&container), "PetscContainerDestroy");
}

// Whether panels solve a system as their factor does, up to rounding; of single precision, as well as a preconditioner
// must.
template <class Factor>
bool agree(const Factor& factor, Panels& panels) {
    std::vector<double> b(factor.unknowns()), x(b.size());
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = static_cast<double>(i % 7) - 2.5;
    const std::vector<double> expected = factor.substituted(b);
    panels.solve(b.data(), x.data());
    double size = 0.0, distance = 0.0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        size += std::abs(expected[i]);
        distance += std::abs(expected[i] - x[i]);
    }
    return distance <= (panels.single ? 1e-3 : 1e-6) * size;
}

// Panels of a factor that agree with it, in single precision where that may be and serves; null where there are none.
template <class Factor>
Shared made_of(const Factor& factor, bool single) {
    if (single) {
        const Shared found = factor.template panels<float>();
        if (!found || agree(factor, *found)) return found;
        if (!factor.known(false)) return nullptr;
    }
    const Shared found = factor.template panels<double>();
    return found && agree(factor, *found) ? found : nullptr;
}

// A factor's panels with its present numbers: those that it has, where they are as exact as asked, or new ones.
template <class Factor>
Shared renewed(const Factor& factor, const Shared& kept, bool single) {
    if (!factor.known(single)) return nullptr;
    if (!kept || (kept->single && !single)) return made_of(factor, single);
    kept->set(factor.values());
    return kept;
}

Shared kept_by_blocks(Mat mat) { return std::dynamic_pointer_cast<Panels>(restshape::kept_substitution(mat)); }

bool solve_by_panels(intptr_t handle, bool single) {
    Mat mat = reinterpret_cast<Mat>(handle);
    if (restshape::in_node_blocks(mat)) {
        const Shared panels = renewed(BlocksFactor(mat), kept_by_blocks(mat), single);
        if (panels) restshape::substitute_by(mat, panels);
        return panels != nullptr;
    }
    PetscBool plain = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATSEQSBAIJ, &plain), "PetscObjectTypeCompare");
    if (!plain) return false;
    MatSolverType maker = nullptr;
    check(MatFactorGetSolverType(mat, &maker), "MatFactorGetSolverType");
    if (!maker || std::strcmp(maker, MATSOLVERPETSC) != 0) return false;
    // A factor keeps its rows for as long as it lives.
    const Shared kept = panels_of(mat), panels = renewed(PetscFactor(mat), kept, single);
    if (!panels) return false;
    if (panels != kept) compose(mat, panels);
    check(MatSetOperation(mat, MATOP_SOLVE, reinterpret_cast<void (*)(void)>(solve)), "MatSetOperation");
    return true;
}

int panel_value_bytes(intptr_t handle) {
    Mat mat = reinterpret_cast<Mat>(handle);
    Shared panels;
    if (restshape::in_node_blocks(mat)) {
        if (restshape::substituted_by_it(mat)) panels = kept_by_blocks(mat);
    } else {
        void (*own)(void) = nullptr;
        check(MatGetOperation(mat, MATOP_SOLVE, &own), "MatGetOperation");
        if (own == reinterpret_cast<void (*)(void)>(solve)) panels = panels_of(mat);
    }
    return panels ? static_cast<int>(panels->single ? sizeof(float) : sizeof(double)) : 0;
}

}  // namespace

void bind_panels(py::module_& m) {
    m.def("solve_by_panels", &solve_by_panels, py::arg("handle"), py::arg("single") = false,
          "Lets MatSolve of a Cholesky factor of PETSc's with this handle go by panels of rows with nearly the same "
          "columns, with its values as they are, until PETSc makes it again. Returns whether it does: a factor of "
          "another kind, one whose own substitutions do not agree, or one of more than 2^24 entries, of "
          "2^27 in single precision, stays as it is.");
    m.def("panel_value_bytes", &panel_value_bytes, py::arg("handle"),
          "Bytes of a number in the panels that MatSolve of the factor with this handle goes by; 0 where it goes by "
          "none.");
}
