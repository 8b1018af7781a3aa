"""VTK's numbers of the cells that recordings hold."""

CELL_TYPES = {2: 3, 3: 5, 4: 10, 6: 22, 8: 12, 10: 24}
"""By the nodes of a cell: line, triangle, tetrahedron, triangle of 6, hexahedron, tetrahedron of 10."""
