"""Elastic solids in the plane, at rest and in motion."""
