"""Cloth: membrane, bending, inertia and contact with bodies."""
