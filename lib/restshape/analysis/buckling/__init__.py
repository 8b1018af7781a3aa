"""Buckling: load factors of solids at rest, their modes and their predictions."""
