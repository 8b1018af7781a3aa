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
// Panels double the memory of a factor: 200 MB beside one with so many entries.
constexpr size_t most_double = 1 << 24, most_single = 1 << 26;

using Rows = restshape::FactorRows<PetscInt>;
using Solve = PetscErrorCode (*)(Mat, Vec, Vec);

// Panels of numbers in double or single precision.
struct Panels {
    virtual ~Panels() = default;
    virtual void set(const double* values) = 0;
    virtual void solve(const double* b, double* x) = 0;
    virtual void forward(const double* b, double* x) = 0;
    virtual void backward(const double* b, double* x) = 0;
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
Panels* panels_of(Mat mat) {
    PetscObject container = nullptr;
    void* context = nullptr;
    check(PetscObjectQuery(reinterpret_cast<PetscObject>(mat), key, &container), "PetscObjectQuery");
    if (!container) return nullptr;
    check(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context), "PetscContainerGetPointer");
    return static_cast<Shared*>(context)->get();
}

// What MatSolve, and the halves of it, call.
template <void (Panels::*way)(const double*, double*)>
PetscErrorCode substitute(Mat mat, Vec b, Vec x) {
    PetscObject container = nullptr;
    void* context = nullptr;
    PetscCall(PetscObjectQuery(reinterpret_cast<PetscObject>(mat), key, &container));
    PetscCall(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context));
    Panels& panels = **static_cast<Shared*>(context);
    const double* right = nullptr;
    double* left = nullptr;
    PetscCall(VecGetArrayRead(b, &right));
    PetscCall(VecGetArrayWrite(x, &left));
    (panels.*way)(right, left);
    PetscCall(VecRestoreArrayWrite(x, &left));
    PetscCall(VecRestoreArrayRead(b, &right));
    return PetscLogFlops(panels.flops());
}

constexpr Solve solve = substitute<&Panels::solve>;

// A factor of PETSc's in symmetric blocks, seen through what it lets everybody see.
class PetscFactor {
 public:
    explicit PetscFactor(Mat mat) : mat_(mat) {
        PetscInt size = 0;
        check(MatGetBlockSize(mat_, &size), "MatGetBlockSize");
        rows_.size = static_cast<int>(size);
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

    bool known(bool single) const { return done_ && own_ && rows_.values() <= (single ? most_single : most_double); }
    const double* values() const { return values_; }

    // Its rows in panels; null where these are no rows of a complete factor in an order of its unknowns.
    template <class Value>
    Shared panels(bool natural) const {
        Shared found;
        try {
            found = std::make_shared<PanelsOf<Value>>(rows_);
        } catch (const std::invalid_argument&) {
            return nullptr;
        }
        found->order = natural ? own_order() : order();
        if (found->order.empty() && unknowns()) return nullptr;
        found->own = own_;
        found->set(values_);
        return found;
    }

    // Whether it solves a system as the panels do, up to rounding; of single precision, as well as a preconditioner
    // must.
    bool agrees(Panels& panels) const {
        const PetscInt n = unknowns();
        std::vector<double> b(n), x(n);
        for (PetscInt i = 0; i < n; ++i) b[i] = static_cast<double>(i % 7) - 2.5;
        const std::vector<double> expected = substituted(b);
        panels.solve(b.data(), x.data());
        double size = 0.0, distance = 0.0;
        for (PetscInt i = 0; i < n; ++i) {
            size += std::abs(expected[i]);
            distance += std::abs(expected[i] - x[i]);
        }
        return distance <= (panels.single ? 1e-3 : 1e-6) * size;
    }

 private:
    std::vector<PetscInt> own_order() const {
        std::vector<PetscInt> found(unknowns());
        std::iota(found.begin(), found.end(), 0);
        return found;
    }

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

    PetscInt unknowns() const { return rows_.count * rows_.size; }

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

// Panels of a factor that agree with it, in single precision where that may be and serves; null where there are none.
Shared made_of(const PetscFactor& factor, bool natural, bool single) {
    if (single) {
        const Shared found = factor.panels<float>(natural);
        if (!found || factor.agrees(*found)) return found;
        if (!factor.known(false)) return nullptr;
    }
    const Shared found = factor.panels<double>(natural);
    return found && factor.agrees(*found) ? found : nullptr;
}

bool solve_by_panels(intptr_t handle, bool single) {
    Mat mat = reinterpret_cast<Mat>(handle);
    Mat inner = restshape::factor_in_blocks(mat);
    if (inner) mat = inner;
    PetscBool plain = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATSEQSBAIJ, &plain), "PetscObjectTypeCompare");
    if (!plain) return false;
    MatSolverType maker = nullptr;
    check(MatFactorGetSolverType(mat, &maker), "MatFactorGetSolverType");
    if (!maker || std::strcmp(maker, MATSOLVERPETSC) != 0) return false;
    const PetscFactor factor(mat);
    if (!factor.known(single)) return false;
    // A factor keeps its rows for as long as it lives.
    Panels* panels = panels_of(mat);
    if (panels && (single || !panels->single)) {
        panels->set(factor.values());
    } else {
        const Shared made = made_of(factor, inner != nullptr, single);
        if (!made) return false;
        compose(mat, made);
    }
    const auto set = [&](MatOperation which, Solve way) {
        check(MatSetOperation(mat, which, reinterpret_cast<void (*)(void)>(way)), "MatSetOperation");
    };
    set(MATOP_SOLVE, solve);
    // Factors in an order of their own, which their callers know.
    if (inner) {
        set(MATOP_FORWARD_SOLVE, substitute<&Panels::forward>);
        set(MATOP_BACKWARD_SOLVE, substitute<&Panels::backward>);
    }
    return true;
}

int panel_value_bytes(intptr_t handle) {
    Mat mat = reinterpret_cast<Mat>(handle);
    if (Mat inner = restshape::factor_in_blocks(mat)) mat = inner;
    void (*own)(void) = nullptr;
    check(MatGetOperation(mat, MATOP_SOLVE, &own), "MatGetOperation");
    const Panels* panels = own == reinterpret_cast<void (*)(void)>(solve) ? panels_of(mat) : nullptr;
    return panels ? static_cast<int>(panels->single ? sizeof(float) : sizeof(double)) : 0;
}

}  // namespace

void bind_panels(py::module_& m) {
    m.def("solve_by_panels", &solve_by_panels, py::arg("handle"), py::arg("single") = false,
          "Lets MatSolve of a Cholesky factor of PETSc's with this handle go by panels of rows with nearly the same "
          "columns, with its values as they are, until PETSc makes it again. Returns whether it does: a factor of "
          "another kind, one whose own substitutions do not agree, or one of more than 2^24 entries, of "
          "2^26 in single precision, stays as it is.");
    m.def("panel_value_bytes", &panel_value_bytes, py::arg("handle"),
          "Bytes of a number in the panels that MatSolve of the factor with this handle goes by; 0 where it goes by "
          "none.");
}
