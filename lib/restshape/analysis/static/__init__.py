"""Equilibrium without time: linear systems, Newton's method, load stepping, and errors of quantities."""
