"""Relaxation: how a body without inertia of its own is brought to a stable equilibrium."""
