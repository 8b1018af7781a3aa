"""Eigenproblems of one frame after the other: pencils, Davidson, Krylov and Schur, inverse iteration."""
