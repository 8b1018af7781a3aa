// A complete Cholesky factor in blocks of one node, as a solver type of PETSc's: -pc_factor_mat_solver_type
// node_blocks.
#pragma once

#include <petscmat.h>

#include <memory>

#include "algebra/block_factor.hpp"
#include "algebra/bordered_pattern.hpp"

namespace restshape {

constexpr char NODE_BLOCKS[] = "node_blocks";

// Makes the solver type known to PETSc, which must have been initialised; calls after the first do nothing.
PetscErrorCode register_node_cholesky();

// Whether a factor is of this type; all that follow want one.
bool in_node_blocks(Mat factor);

// Its rows in elimination order, without values where it has not been made, and unknowns a node.
BlockRows factor_rows(Mat factor);
PetscInt factor_block_size(Mat factor);

// What substitutes in elimination order in the place of a factor's own rows, whose numbers it has copied.
struct Substitution {
    virtual ~Substitution() = default;
    virtual void solve(const double* b, double* x) = 0;  // x may be b
    virtual void forward(const double* b, double* x) = 0;
    virtual void backward(const double* b, double* x) = 0;
};

// Has a factor substitute so until it is made again; the last one told on this pattern, null before; and whether it has
// the factor's present numbers.
void substitute_by(Mat factor, std::shared_ptr<Substitution> way);
std::shared_ptr<Substitution> kept_substitution(Mat factor);
bool substituted_by_it(Mat factor);

// Solves by the factor's own rows for all unknowns x in elimination order, which are the right side before.
void substitute_in_place(Mat factor, double* x);

// Has a factor of this type, not made yet, keep the last unknowns, whole nodes of them: they are no pivots. Solutions
// are then those with these unknowns 0. A node has so many unknowns (`fields`), which small patterns do not show.
PetscErrorCode keep_border(Mat factor, PetscInt unknowns, PetscInt fields);
PetscErrorCode kept_border(Mat factor, PetscInt* unknowns);

// Makes a factor of this type, whose border has been given, of a rank's rows inside and their border: of what
// `bordered_pattern` lays out, read where PETSc keeps it. Its pattern is that of the first call.
PetscErrorCode factor_shared_rows(Mat factor, const SharedRows& rows, const PetscInt* number);

// The Schur complement of what a factor keeps, by rows.
PetscErrorCode border_complement(Mat factor, double* complement);

// A solution with unknowns of the border that are not 0, in two halves: what the equations of the border have on their
// right without the inside, from its right side; and the inside's unknowns, once those of the border are known. Nothing
// else is solved with the factor in between.
PetscErrorCode eliminate_inside(Mat factor, const double* inside, double* border);
PetscErrorCode complete_inside(Mat factor, const double* border, double* inside);

}  // namespace restshape
