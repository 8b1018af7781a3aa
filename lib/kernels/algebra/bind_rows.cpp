// Products of few long rows, such as the vectors of a search space: with each other, and with a matrix that is read
// once for eight of them.
#include <petscmat.h>
#include <petscsf.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "algebra/matrix_rows.hpp"
#include "algebra/ridge.hpp"

namespace py = pybind11;
using restshape::check;
using restshape::MatrixRows;
using Reals = py::array_t<double, py::array::c_style>;

namespace {

constexpr int lanes = 8, fields = 3;
constexpr py::ssize_t strip = 512;  // columns that stay in the first cache
using Lanes = Eigen::Array<double, lanes, 1>;
using Beside = std::vector<Lanes, Eigen::aligned_allocator<Lanes>>;

Lanes load(const double* from) { return Eigen::Map<const Lanes>(from); }
void store(double* to, const Lanes& what) { Eigen::Map<Lanes>{to} = what; }

// A function of a number of rows that the compiler knows.
template <int most, class Visit>
void with_count(py::ssize_t count, Visit visit) {
    if constexpr (most > 1) {
        if (count < most) return with_count<most - 1>(count, visit);
    }
    visit(std::integral_constant<int, most>{});
}

// Products of A rows with B rows over columns from:to, added to `out`, whose rows are `stride` apart.
template <int A, int B>
void add_gram(const double* a, const double* b, py::ssize_t n, py::ssize_t from, py::ssize_t to, double* out,
              py::ssize_t stride) {
    Lanes sum[A][B];
    for (auto& row : sum)
        for (Lanes& one : row) one.setZero();
    py::ssize_t i = from;
    for (; i + lanes <= to; i += lanes) {
        Lanes right[B];
        for (int l = 0; l < B; ++l) right[l] = load(b + l * n + i);
        for (int k = 0; k < A; ++k) {
            const Lanes left = load(a + k * n + i);
            for (int l = 0; l < B; ++l) sum[k][l] += left * right[l];
        }
    }
    for (int k = 0; k < A; ++k)
        for (int l = 0; l < B; ++l) {
            double rest = sum[k][l].sum();
            for (py::ssize_t j = i; j < to; ++j) rest += a[k * n + j] * b[l * n + j];
            out[k * stride + l] += rest;
        }
}

void row_products(const Reals& a, const Reals& b, Reals out) {
    if (a.ndim() != 2 || b.ndim() != 2 || out.ndim() != 2 || a.shape(1) != b.shape(1) || out.shape(0) != a.shape(0) ||
        out.shape(1) != b.shape(0))
        throw std::invalid_argument("a must be (k, n), b (m, n), out (k, m)");
    const py::ssize_t n = a.shape(1), k = a.shape(0), m = b.shape(0);
    double* to = out.mutable_data();
    std::fill(to, to + k * m, 0.0);
    for (py::ssize_t from = 0; from < n; from += strip)
        for (py::ssize_t p = 0; p < k; p += 4)
            for (py::ssize_t q = 0; q < m; q += 4)
                with_count<4>(std::min<py::ssize_t>(4, k - p), [&](auto A) {
                    with_count<4>(std::min<py::ssize_t>(4, m - q), [&](auto B) {
                        add_gram<A(), B()>(a.data() + p * n, b.data() + q * n, n, from, std::min(from + strip, n),
                                           to + p * m + q, m);
                    });
                });
}

// M rows of the sum of `count` rows with weights, over columns from:to, added to `out` or in its place.
template <int M>
void combine(const double* weights, py::ssize_t count, const double* rows, py::ssize_t n, py::ssize_t from,
             py::ssize_t to, double* out, bool add) {
    py::ssize_t i = from;
    for (; i + lanes <= to; i += lanes) {
        Lanes sum[M];
        for (int k = 0; k < M; ++k) sum[k] = add ? load(out + k * n + i) : Lanes::Zero();
        for (py::ssize_t j = 0; j < count; ++j) {
            const Lanes one = load(rows + j * n + i);
            for (int k = 0; k < M; ++k) sum[k] += weights[k * count + j] * one;
        }
        for (int k = 0; k < M; ++k) store(out + k * n + i, sum[k]);
    }
    for (; i < to; ++i)
        for (int k = 0; k < M; ++k) {
            double sum = add ? out[k * n + i] : 0.0;
            for (py::ssize_t j = 0; j < count; ++j) sum += weights[k * count + j] * rows[j * n + i];
            out[k * n + i] = sum;
        }
}

void combine_rows(const Reals& weights, const Reals& rows, Reals out, bool add) {
    if (weights.ndim() != 2 || rows.ndim() != 2 || out.ndim() != 2 || weights.shape(1) != rows.shape(0) ||
        out.shape(0) != weights.shape(0) || out.shape(1) != rows.shape(1))
        throw std::invalid_argument("weights must be (m, k), rows (k, n), out (m, n)");
    const py::ssize_t m = weights.shape(0), count = weights.shape(1), n = rows.shape(1);
    if (out.data() == rows.data() && out.size() && rows.size()) throw std::invalid_argument("out must not be rows");
    for (py::ssize_t from = 0; from < n; from += strip)
        for (py::ssize_t p = 0; p < m; p += lanes)
            with_count<lanes>(std::min<py::ssize_t>(lanes, m - p), [&](auto M) {
                combine<M()>(weights.data() + p * count, count, rows.data(), n, from, std::min(from + strip, n),
                             out.mutable_data() + p * n, add);
            });
}

// Products of S rows of a matrix that have the same columns.
template <int S>
void multiply(const MatrixRows& a, PetscInt row, const Beside& x, Lanes* out) {
    const PetscInt count = a.start[row + 1] - a.start[row], *column = a.column + a.start[row];
    const double* value = a.value + a.start[row];
    Lanes sum[S];
    for (Lanes& one : sum) one.setZero();
    for (PetscInt k = 0; k < count; ++k) {
        const Lanes& one = x[column[k]];
        for (int s = 0; s < S; ++s) sum[s] += value[s * count + k] * one;
    }
    for (int s = 0; s < S; ++s) out[s] = sum[s];
}

// Unknowns of a node have the same columns.
bool alike(const MatrixRows& a, PetscInt row) {
    const PetscInt count = a.start[row + 1] - a.start[row], *column = a.column + a.start[row];
    for (int s = 1; s < fields; ++s)
        if (a.start[row + s + 1] - a.start[row + s] != count || !std::equal(column, column + count, column + s * count))
            return false;
    return true;
}

// Rows of a matrix times up to eight vectors that lie side by side: calls take(row, products).
template <typename Take>
void multiply_rows(const MatrixRows& a, const Beside& x, Take&& take) {
    Lanes product[fields];
    for (PetscInt i = 0; i < a.n;) {
        const bool node = i + fields <= a.n && alike(a, i);
        node ? multiply<fields>(a, i, x, product) : multiply<1>(a, i, x, product);
        const int size = node ? fields : 1;
        for (int s = 0; s < size; ++s) take(i + s, product[s]);
        i += size;
    }
}

bool of_type(Mat mat, MatType type) {
    PetscBool is = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), type, &is), "PetscObjectTypeCompare");
    return is;
}

// Who has the columns of a matrix that other ranks own; it stays with the matrix, whose pattern does.
PetscSF ghosts_of(Mat mat, const PetscInt* columns, PetscInt count) {
    constexpr char name[] = "restshape_ghosts";
    PetscObject kept = nullptr;
    check(PetscObjectQuery(reinterpret_cast<PetscObject>(mat), name, &kept), "PetscObjectQuery");
    if (kept) return reinterpret_cast<PetscSF>(kept);
    MPI_Comm comm = MPI_COMM_NULL;
    check(PetscObjectGetComm(reinterpret_cast<PetscObject>(mat), &comm), "PetscObjectGetComm");
    PetscLayout layout = nullptr;
    check(MatGetLayouts(mat, nullptr, &layout), "MatGetLayouts");
    PetscSF sf = nullptr;
    check(PetscSFCreate(comm, &sf), "PetscSFCreate");
    check(PetscSFSetGraphLayout(sf, layout, count, nullptr, PETSC_COPY_VALUES, columns), "PetscSFSetGraphLayout");
    check(PetscObjectCompose(reinterpret_cast<PetscObject>(mat), name, reinterpret_cast<PetscObject>(sf)),
          "PetscObjectCompose");
    PetscSF held = sf;
    // The matrix has it now.
    check(PetscSFDestroy(&sf), "PetscSFDestroy");
    return held;
}

// What other ranks have of vectors that lie side by side, in one message from each of them.
void exchange(PetscSF sf, const Beside& own, Beside& others) {
    MPI_Datatype unit = MPI_DATATYPE_NULL;
    MPI_Type_contiguous(lanes, MPI_DOUBLE, &unit);
    MPI_Type_commit(&unit);
    check(PetscSFBcastBegin(sf, unit, own.data(), others.data(), MPI_REPLACE), "PetscSFBcastBegin");
    check(PetscSFBcastEnd(sf, unit, own.data(), others.data(), MPI_REPLACE), "PetscSFBcastEnd");
    MPI_Type_free(&unit);
}

bool matrix_products(intptr_t handle, const Reals& rows, Reals out) {
    Mat mat = reinterpret_cast<Mat>(handle), own = mat, border = nullptr;
    const bool shared = of_type(mat, MATMPIAIJ);
    if (!shared && !of_type(mat, MATSEQAIJ)) return false;
    const PetscInt* columns = nullptr;
    if (shared) check(MatMPIAIJGetSeqAIJ(mat, &own, &border, &columns), "MatMPIAIJGetSeqAIJ");
    const MatrixRows a(own);
    if (!a.done) return false;
    if (rows.ndim() != 2 || out.ndim() != 2 || rows.shape(1) != a.n || out.shape(0) != rows.shape(0) ||
        out.shape(1) != a.n)
        throw std::invalid_argument("rows and out must be (k, n)");
    PetscInt ghosts = 0;
    PetscSF sf = nullptr;
    if (shared) {
        check(MatGetSize(border, nullptr, &ghosts), "MatGetSize");
        sf = ghosts_of(mat, columns, ghosts);
    }
    // Side by side: a product with all of them is one with a register.
    Beside beside(a.n), others(ghosts), from_others(shared ? a.n : 0);
    const py::ssize_t count = rows.shape(0), n = a.n;
    for (py::ssize_t first = 0; first < count; first += lanes) {
        const int width = static_cast<int>(std::min<py::ssize_t>(lanes, count - first));
        const double* from = rows.data() + first * n;
        double* to = out.mutable_data() + first * n;
        for (py::ssize_t i = 0; i < n; ++i)
            for (int k = 0; k < lanes; ++k) beside[i][k] = k < width ? from[k * n + i] : 0.0;
        if (shared) {
            exchange(sf, beside, others);
            multiply_rows(MatrixRows(border), others, [&](PetscInt i, const Lanes& sum) { from_others[i] = sum; });
        }
        multiply_rows(a, beside, [&](PetscInt i, const Lanes& sum) {
            const Lanes whole = shared ? Lanes(sum + from_others[i]) : sum;
            for (int k = 0; k < width; ++k) to[k * n + i] = whole[k];
        });
    }
    check(PetscLogFlops(2.0 * static_cast<double>(a.start[a.n]) * static_cast<double>(count)), "PetscLogFlops");
    return true;
}

void guess_step(const Reals& forces, const Reals& gram, double ridge, const Reals& steps, Reals products, Reals guess) {
    const py::ssize_t kept = steps.ndim() == 2 ? steps.shape(0) : -1, n = kept > 0 ? steps.shape(1) : 0;
    if (kept < 1 || forces.ndim() != 2 || forces.shape(0) != kept + 1 || gram.size() != kept * kept ||
        products.size() != kept + 1 || guess.size() != n)
        throw std::invalid_argument(
            "steps must be (k, n), forces (k + 1, m), gram (k, k), products (k + 1,), guess (n,)");
    const py::ssize_t rows = forces.shape(1);
    // Views of what there is.
    row_products(forces, Reals({py::ssize_t{1}, rows}, forces.data() + kept * rows, forces),
                 Reals({kept + 1, py::ssize_t{1}}, products.mutable_data(), products));
    std::vector<double> weights(kept), sum(n);
    restshape::solve_with_ridge(gram.data(), products.data(), kept, ridge, weights.data());
    combine<1>(weights.data(), kept, steps.data(), n, 0, n, sum.data(), false);
    double* to = guess.mutable_data();
    for (py::ssize_t i = 0; i < n; ++i) to[i] += sum[i];
}

void keep_step(const Reals& now, const Reals& before, const Reals& products, py::ssize_t place, Reals steps,
               Reals forces, Reals gram) {
    const py::ssize_t kept = steps.ndim() == 2 ? steps.shape(0) : -1, n = kept > 0 ? steps.shape(1) : 0;
    if (kept < 1 || now.size() != n || before.size() != n || forces.ndim() != 2 || forces.shape(0) != kept + 1 ||
        gram.size() != kept * kept || products.size() != kept + 1 || place < 0 || place >= kept)
        throw std::invalid_argument("steps must be (k, n), now and before (n,), forces (k + 1, m), gram (k, k)");
    const py::ssize_t rows = forces.shape(1);
    double *step = steps.mutable_data() + place * n, *force = forces.mutable_data(), *products_of = gram.mutable_data();
    for (py::ssize_t i = 0; i < n; ++i) step[i] = now.data()[i] - before.data()[i];
    std::copy_n(force + kept * rows, rows, force + place * rows);
    for (py::ssize_t k = 0; k < kept; ++k)
        products_of[place * kept + k] = products_of[k * kept + place] = products.data()[k];
    products_of[place * kept + place] = products.data()[kept];
}

// A vector like another one, which is made once and lives as long as that one, or a duplicate of it, does.
Vec vector_beside(Vec vector) {
    constexpr const char* name = "restshape_beside";
    PetscObject known = nullptr;
    check(PetscObjectQuery(reinterpret_cast<PetscObject>(vector), name, &known), "PetscObjectQuery");
    if (known) return reinterpret_cast<Vec>(known);
    Vec made = nullptr;
    check(VecDuplicate(vector, &made), "VecDuplicate");
    check(PetscObjectCompose(reinterpret_cast<PetscObject>(vector), name, reinterpret_cast<PetscObject>(made)),
          "PetscObjectCompose");
    check(VecDestroy(&made), "VecDestroy");
    check(PetscObjectQuery(reinterpret_cast<PetscObject>(vector), name, &known), "PetscObjectQuery");
    return reinterpret_cast<Vec>(known);
}

double residual_norm(intptr_t mat, intptr_t right, intptr_t solution) {
    Vec b = reinterpret_cast<Vec>(right), rest = vector_beside(b);
    check(MatMult(reinterpret_cast<Mat>(mat), reinterpret_cast<Vec>(solution), rest), "MatMult");
    check(VecAYPX(rest, -1.0, b), "VecAYPX");
    PetscReal norm = 0.0;
    check(VecNorm(rest, NORM_2, &norm), "VecNorm");
    return norm;
}

}  // namespace

void bind_rows(py::module_& m) {
    m.def("guess_step", &guess_step, py::arg("forces").noconvert(), py::arg("gram").noconvert(), py::arg("ridge"),
          py::arg("steps").noconvert(), py::arg("products").noconvert(), py::arg("guess").noconvert(),
          "Writes the products (k + 1,) of forces (k + 1, m) with the last of them, and adds to guess (n,) the steps "
          "(k, n) "
          "with the weights of (gram + ridge trace(gram)) w = products.");
    m.def("keep_step", &keep_step, py::arg("now").noconvert(), py::arg("before").noconvert(),
          py::arg("products").noconvert(), py::arg("place"), py::arg("steps").noconvert(),
          py::arg("forces").noconvert(), py::arg("gram").noconvert(),
          "Writes now - before (n,) to this place of steps (k, n), the last of forces (k + 1, m) to that of the "
          "others, and "
          "its products (k + 1,) with all to that of gram (k, k).");
    m.def("residual_norm", &residual_norm, py::arg("mat"), py::arg("b"), py::arg("x"),
          "The norm of b - A x, of handles of PETSc's matrix A and vectors; collective. The vector in which it is made "
          "stays with b.");
    m.def("row_products", &row_products, py::arg("a").noconvert(), py::arg("b").noconvert(), py::arg("out").noconvert(),
          "Writes the scalar products (k, m) of rows a (k, n) with rows b (m, n).");
    m.def("combine_rows", &combine_rows, py::arg("weights").noconvert(), py::arg("rows").noconvert(),
          py::arg("out").noconvert(), py::arg("add"),
          "Writes, or adds, weights (m, k) times rows (k, n) to out (m, n).");
    m.def(
        "matrix_products", &matrix_products, py::arg("handle"), py::arg("rows").noconvert(), py::arg("out").noconvert(),
        "Writes the products with PETSc's matrix of this handle of each of rows (k, n) into out (k, n); its entries "
        "are read once for eight rows. Of a matrix that ranks share rows are this rank's columns of them, and the call "
        "is collective. Returns whether it does: of matrices other than by rows it writes nothing.");
}
