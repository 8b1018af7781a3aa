"""Conduction of heat in the plane, steady and in time."""
