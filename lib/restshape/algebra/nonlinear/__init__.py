"""Nonlinear solvers on PETSc's SNES: Newton's method, descents, kinetic damping, and the linear solves in them."""
