"""Algebra: operators with kept patterns, linear solvers with kept preconditioners."""
