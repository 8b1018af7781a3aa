"""The finite-element layer: spaces, integrals over them, boundary conditions, problems and their quantities."""
