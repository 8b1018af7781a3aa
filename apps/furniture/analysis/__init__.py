"""Equilibrium of a piece, frame after frame."""
