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
constexpr size_t most_entries = 1 << 24;

using Factor = restshape::PanelFactor<PetscInt>;
struct Panels {
    Factor factor;
    std::vector<PetscInt> order;
};
using Shared = std::shared_ptr<Panels>;
using Solve = PetscErrorCode (*)(Mat, Vec, Vec);

PetscErrorCode release(void* context) {
    delete static_cast<Shared*>(context);
    return 0;
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
    panels.factor.solve(right, panels.order.data(), left);
    PetscCall(VecRestoreArrayWrite(x, &left));
    PetscCall(VecRestoreArrayRead(b, &right));
    return PetscLogFlops(4.0 * static_cast<double>(panels.factor.entries()) - 3.0 * panels.factor.size());
}

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
    }
    ~PetscFactor() {
        (void)MatSeqSBAIJRestoreArray(mat_, &values_);
        (void)MatRestoreRowIJ(mat_, 0, PETSC_FALSE, blocks_, &rows_.count, &rows_.start, &rows_.column, &done_);
    }
    PetscFactor(const PetscFactor&) = delete;
    PetscFactor& operator=(const PetscFactor&) = delete;

    bool known() const { return done_ && own_ && rows_.values() <= most_entries; }
    bool by_panels() const { return own_ == solve; }
    const double* values() const { return values_; }

    // Its rows in panels, with the numbers of the unknowns that they are of: without entries beside the diagonal, and
    // there the rows' own numbers, a substitution gives each unknown the number of its row.
    Shared panels() const {
        const PetscInt n = unknowns();
        Shared found;
        try {
            found = std::make_shared<Panels>(Panels{Factor(rows_), std::vector<PetscInt>(n)});
        } catch (const std::invalid_argument&) {
            return nullptr;
        }
        const std::vector<double> kept(values_, values_ + rows_.values()), ones(n, 1.0);
        std::fill(values_, values_ + rows_.values(), 0.0);
        for (PetscInt k = 0; k < rows_.count; ++k)
            for (int r = 0; r < rows_.size; ++r)
                values_[rows_.pivot(k, r, r)] = static_cast<double>(k * rows_.size + r);
        std::vector<double> row;
        try {
            row = substituted(ones);
        } catch (...) {
            std::copy(kept.begin(), kept.end(), values_);
            throw;
        }
        std::copy(kept.begin(), kept.end(), values_);
        std::vector<char> seen(n, 0);
        for (PetscInt k = 0; k < n; ++k) {
            const double i = row[k];
            if (!(i >= 0.0 && i < n && i == std::floor(i)) || seen[static_cast<PetscInt>(i)]++) return nullptr;
            found->order[static_cast<PetscInt>(i)] = k;
        }
        return found;
    }

    // Whether it solves a system as the panels do, up to rounding.
    bool agrees(Panels& panels) const {
        const PetscInt n = unknowns();
        std::vector<double> b(n), x(n);
        for (PetscInt i = 0; i < n; ++i) b[i] = static_cast<double>(i % 7) - 2.5;
        const std::vector<double> expected = substituted(b);
        panels.factor.solve(b.data(), panels.order.data(), x.data());
        double size = 0.0, distance = 0.0;
        for (PetscInt i = 0; i < n; ++i) {
            size += std::abs(expected[i]);
            distance += std::abs(expected[i] - x[i]);
        }
        return distance <= 1e-6 * size;
    }

 private:
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
    Factor::Rows rows_{};
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

// The panels that a factor goes by; none yet, or none that PETSc's own substitutions agree with.
Panels* panels_of(Mat mat) {
    PetscObject container = nullptr;
    void* context = nullptr;
    check(PetscObjectQuery(reinterpret_cast<PetscObject>(mat), key, &container), "PetscObjectQuery");
    if (!container) return nullptr;
    check(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context), "PetscContainerGetPointer");
    return static_cast<Shared*>(context)->get();
}

bool solve_by_panels(intptr_t handle) {
    Mat mat = reinterpret_cast<Mat>(handle);
    if (Mat inner = restshape::factor_in_blocks(mat)) mat = inner;
    PetscBool plain = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATSEQSBAIJ, &plain), "PetscObjectTypeCompare");
    if (!plain) return false;
    MatSolverType maker = nullptr;
    check(MatFactorGetSolverType(mat, &maker), "MatFactorGetSolverType");
    if (!maker || std::strcmp(maker, MATSOLVERPETSC) != 0) return false;
    const PetscFactor factor(mat);
    if (!factor.known()) return false;
    // A factor keeps its rows for as long as it lives.
    if (Panels* panels = panels_of(mat)) {
        panels->factor.set(factor.values());
    } else {
        if (factor.by_panels()) return false;
        const Shared made = factor.panels();
        if (!made) return false;
        made->factor.set(factor.values());
        if (!factor.agrees(*made)) return false;
        compose(mat, made);
    }
    check(MatSetOperation(mat, MATOP_SOLVE, reinterpret_cast<void (*)(void)>(solve)), "MatSetOperation");
    return true;
}

}  // namespace

void bind_panels(py::module_& m) {
    m.def("solve_by_panels", &solve_by_panels, py::arg("handle"),
          "Lets MatSolve of a Cholesky factor of PETSc's with this handle go by panels of rows with nearly the same "
          "columns, with its values as they are, until PETSc makes it again. Returns whether it does: a factor of "
          "another kind, one whose own substitutions do not agree, or one of more than 2^24 entries stays as it is.");
}
