"""Outlines from drawings: DXF, SVG, STEP and Gmsh geometry files, by loose curves that are joined into loops."""
