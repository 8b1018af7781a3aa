// The graph of nodes behind a symmetric sparse matrix, its elimination order, and where the matrix's values go.
#pragma once

#include <petscmat.h>

#include <vector>

namespace restshape {

// Rows and columns of a sequential AIJ matrix, as PETSc holds them.
struct Pattern {
    PetscInt rows;
    const PetscInt *starts, *columns;
};

// Blocks of the upper triangle of P A P', P the elimination order of nodes.
struct UpperBlocks {
    PetscInt size = 1;                      // unknowns a node
    std::vector<PetscInt> order;            // of nodes: the k-th to be eliminated
    std::vector<PetscInt> starts, columns;  // of block rows
    std::vector<PetscInt> from;             // of each block, where its first value is stored in A
    std::vector<PetscInt> length;           // of each block row, values from one row of A to the next
};

// The most unknowns a node, 3, 2 or 1, for which all rows of a node have the same columns, whole nodes of
// them; of `fields`, where they are given, or 1.
PetscInt block_size(const Pattern& a, PetscInt fields = 0);

// Approximate minimum degree, which is quick, or nested dissection, whose factors take fewer products on large sheets.
enum class Elimination { minimum_degree, dissection };

// Orders nodes, those that are kept, the last ones, behind the others, and lays the blocks out. Where there is no
// nested dissection minimum degree takes its place.
PetscErrorCode make_blocks(const Pattern& a, PetscInt size, UpperBlocks* blocks, PetscInt kept = 0,
                           Elimination by = Elimination::minimum_degree);

// Whether PETSc has come with nested dissection.
bool has_dissection();

}  // namespace restshape
