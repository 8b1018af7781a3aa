"""Plates with shear over plane meshes."""
