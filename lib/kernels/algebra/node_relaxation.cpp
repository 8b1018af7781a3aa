#include "algebra/node_relaxation.hpp"

#include <petsc/private/kspimpl.h>

#include <cmath>

#include "algebra/relaxed_matrix.hpp"

// S. C. Eisenstat, SIAM J. Sci. Stat. Comput. 2 (1981) 1: of A = L + D + L^T the preconditioner (D/w + L) (D/w)^-1
// (D/w + L^T) shares both halves. A p for p = (D/w + L^T)^-1 g is g + L p and a part of D p, so that the sweeps read
// all that a product needs. L p comes along with the lower sweep, so that the norm is that of the residual itself.
//
// As L is rounded, that residual drifts from b - A x. Where the drift may be a part of the residual that is reached,
// b - A x takes its place, and the iterations begin anew if it is larger.

namespace restshape {
namespace {

struct NodeRelaxation {
    RelaxedMatrix matrix;
    Rows x, b, r, y, z, g, p, q, s, change;

    void resize(PetscInt n) {
        for (Rows* one : {&x, &b, &r, &y, &z, &g, &p, &q, &s, &change}) one->resize(n);
    }
};

constexpr double drifted = 0.1;  // part of a residual

void put(const double* from, Rows& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = {from[3 * i], from[3 * i + 1], from[3 * i + 2], 0.0};
}

double square(const Rows& one) {
    double sum = 0.0;
    for (const Row& row : one) sum += row.square().sum();
    return sum;
}

// Sets ksp->reason where the residual, whose square is `rest`, ends the iterations.
PetscErrorCode test(KSP ksp, double rest) {
    PetscFunctionBegin;
    ksp->rnorm = std::sqrt(rest);
    PetscCall(KSPLogResidualHistory(ksp, ksp->rnorm));
    PetscCall(KSPMonitor(ksp, ksp->its, ksp->rnorm));
    PetscCall((*ksp->converged)(ksp, ksp->its, ksp->rnorm, &ksp->reason, ksp->cnvP));
    if (!ksp->reason && ksp->its >= ksp->max_it) ksp->reason = KSP_DIVERGED_ITS;
    PetscFunctionReturn(0);
}

// Goes on from x with its residual r until ksp->reason is set. Sets drift to how far r may be from b - A x then.
PetscErrorCode iterate(KSP ksp, NodeRelaxation& w, double& drift) {
    const PetscInt n = w.matrix.rows();
    double rest = square(w.r), beta = 0.0, rho = 0.0;
    PetscFunctionBegin;
    std::fill(w.g.begin(), w.g.end(), Row::Zero());
    drift = 0.0;
    for (bool begins = true;; begins = false, ++ksp->its) {
        PetscCall(test(ksp, rest));
        if (ksp->reason) break;
        // y and z come from r.
        if (begins) rho = w.matrix.lower_half(w.r.data(), w.y.data(), w.z.data());
        w.matrix.upper_half(beta, w.z.data(), w.g.data(), w.p.data());
        const auto sizes = w.matrix.product(w.g.data(), w.p.data(), w.s.data(), w.q.data(), w.change.data());
        if (!(sizes.energy > 0.0)) {
            ksp->reason = std::isnan(sizes.energy) ? KSP_DIVERGED_NANORINF : KSP_DIVERGED_INDEFINITE_MAT;
            break;
        }
        const double alpha = rho / sizes.energy;
        drift += alpha * RelaxedMatrix::rounding * std::sqrt(sizes.own);
        double next = 0.0;
        rest = 0.0;
        for (PetscInt i = 0; i < n; ++i) {
            w.x[i] += alpha * w.p[i];
            w.r[i] -= alpha * w.q[i];
            w.z[i] -= alpha * w.change[i];
            rest += w.r[i].square().sum();
            next += w.matrix.square(i, w.z[i]);
        }
        beta = next / rho;
        rho = next;
    }
    PetscFunctionReturn(0);
}

// Iterates until b - A x itself is as small as is wanted.
PetscErrorCode iterate_exactly(KSP ksp, NodeRelaxation& w) {
    double drift = 0.0;
    PetscFunctionBegin;
    for (ksp->its = 0;;) {
        PetscCall(iterate(ksp, w, drift));
        if (ksp->reason < 0 || drift <= drifted * ksp->rnorm) break;
        w.matrix.residual(w.b.data(), w.x.data(), w.r.data());
        ksp->reason = KSP_CONVERGED_ITERATING;
    }
    PetscFunctionReturn(0);
}

PetscErrorCode solve(KSP ksp) {
    NodeRelaxation& w = *static_cast<NodeRelaxation*>(ksp->data);
    Mat A;
    PetscInt n, size;
    const PetscInt *start, *column;
    const double* right;
    double *values, *left;
    PetscBool done, blocks;
    PetscFunctionBegin;
    PetscCall(PCGetOperators(ksp->pc, &A, nullptr));
    PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(A), MATSEQBAIJ, &blocks));
    PetscCall(MatGetBlockSize(A, &size));
    PetscCheck(blocks && size == 3, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_ssor needs a matrix seqbaij in blocks of 3");
    PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_TRUE, &n, &start, &column, &done));
    PetscCall(MatSeqBAIJGetArray(A, &values));
    w.resize(n);
    ksp->reason = KSP_CONVERGED_ITERATING;
    if (!done || !w.matrix.set_pattern(n, start, column) || !w.matrix.set_values(values))
        ksp->reason = KSP_DIVERGED_INDEFINITE_PC;
    if (!ksp->reason) {
        PetscCall(VecGetArrayRead(ksp->vec_rhs, &right));
        put(right, w.b);
        PetscCall(VecRestoreArrayRead(ksp->vec_rhs, &right));
        PetscCall(VecGetArray(ksp->vec_sol, &left));
        std::fill(w.x.begin(), w.x.end(), Row::Zero());
        w.r = w.b;
        if (!ksp->guess_zero) {
            put(left, w.x);
            w.matrix.residual(w.b.data(), w.x.data(), w.r.data());
        }
        PetscCall(iterate_exactly(ksp, w));
        for (PetscInt i = 0; i < n; ++i) std::copy_n(w.x[i].data(), 3, left + 3 * i);
        PetscCall(VecRestoreArray(ksp->vec_sol, &left));
        PetscCall(PetscLogFlops((ksp->its + 1.0) * (54.0 * start[n] + 100.0 * n)));
    }
    PetscCall(MatSeqBAIJRestoreArray(A, &values));
    PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_TRUE, &n, &start, &column, &done));
    PetscFunctionReturn(0);
}

PetscErrorCode set_up(KSP) { return 0; }

PetscErrorCode destroy(KSP ksp) {
    PetscFunctionBegin;
    delete static_cast<NodeRelaxation*>(ksp->data);
    ksp->data = nullptr;
    PetscFunctionReturn(0);
}

PetscErrorCode create(KSP ksp) {
    PetscFunctionBegin;
    ksp->data = new NodeRelaxation;
    PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_UNPRECONDITIONED, PC_LEFT, 3));
    PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_NONE, PC_LEFT, 1));
    ksp->ops->setup = set_up;
    ksp->ops->solve = solve;
    ksp->ops->destroy = destroy;
    ksp->ops->buildsolution = KSPBuildSolutionDefault;
    ksp->ops->buildresidual = KSPBuildResidualDefault;
    PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode register_node_relaxation() {
    static bool known = false;
    PetscFunctionBegin;
    if (!known) PetscCall(KSPRegister(NODE_SSOR, create));
    known = true;
    PetscFunctionReturn(0);
}

}  // namespace restshape
