"""Writes the sample meshes of this folder: python meshes/write_samples.py.

bracket.*: an L of 3 x 2 cm with a hole, in millimetres, the same mesh in each format. The left side is clamped
("clamp"), the right end is loaded ("load"), and the corner of the L is of another material ("corner").
"""

from pathlib import Path

import meshio
import numpy as np

from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.outline import Outline

FOLDER = Path(__file__).parent


def bracket() -> Mesh:
    """The L, in millimetres."""
    corners = {"a": (0, 0), "b": (30, 0), "c": (30, 8), "d": (10, 8), "e": (10, 20), "f": (0, 20)}
    names = "bottom", "load", "inside", "upright", "top", "clamp"
    ring = [*corners, "a"]
    shape = ShapeSpec(
        vertices={name: list(p) for name, p in corners.items()},
        edges={name: {"line": [a, b]} for name, a, b in zip(names, ring, ring[1:])},
        outline=list(names),
        holes={"bolt": {"circle": {"center": [22, 4], "radius": 1.8}}},
        regions={"corner": {"polygon": [[1, 1], [8, 1], [8, 6], [1, 6]]}},
    )
    return generate(Outline.from_spec(shape), MeshSpec(size=2.0, near={"bolt": 0.7}))


def nastran(mesh: Mesh) -> str:
    """A deck in small fields: the clamp as SPC set 1, the corner as property 2."""
    lines = ["SOL 101", "CEND", "BEGIN BULK"]
    lines += [f"GRID    {i:8d}        {x:8.4f}{y:8.4f}{0.0:8.4f}" for i, (x, y) in enumerate(mesh.X.tolist(), 1)]
    for i, (cell, region) in enumerate(zip((mesh.cells + 1).tolist(), mesh.cell_region.tolist()), 1):
        lines.append(f"CTRIA3  {i:8d}{region + 1:8d}{cell[0]:8d}{cell[1]:8d}{cell[2]:8d}")
    clamped = (mesh.nodes_of("clamp") + 1).tolist()
    for i in range(0, len(clamped), 6):
        lines.append("SPC1    " + "".join(f"{n:8d}" for n in (1, 12, *clamped[i : i + 6])))
    return "\n".join([*lines, "ENDDATA", ""])


def abaqus(mesh: Mesh) -> str:
    """An input file with node sets and an element set."""
    lines = ["*HEADING", "L bracket, mm", "*NODE"]
    lines += [f"{i}, {x:.9g}, {y:.9g}, 0." for i, (x, y) in enumerate(mesh.X.tolist(), 1)]
    lines.append("*ELEMENT, TYPE=CPS3, ELSET=bracket")
    lines += [f"{i}, {a}, {b}, {c}" for i, (a, b, c) in enumerate((mesh.cells + 1).tolist(), 1)]
    sets = [("NSET", name, mesh.nodes_of(name)) for name in ("clamp", "load", "bolt")]
    for kind, name, rows in [*sets, ("ELSET", "corner", mesh.cells_of("corner"))]:
        lines.append(f"*{kind}, {kind}={name}")
        numbers = (rows + 1).tolist()
        lines += [", ".join(map(str, numbers[i : i + 12])) for i in range(0, len(numbers), 12)]
    return "\n".join([*lines, ""])


def tagged(mesh: Mesh) -> meshio.Mesh:
    """Triangles and boundary lines with integer groups: 1 clamp, 2 load, 3 bolt, 10 elsewhere; 11 in the corner."""
    tag = np.zeros(len(mesh.facets), dtype=np.int32)
    for value, name in enumerate(("clamp", "load", "bolt"), 1):
        tag[mesh.facets_of(name)] = value
    named = tag > 0
    points = np.column_stack([mesh.X, np.zeros(mesh.n_nodes)])
    groups = [tag[named], 10 + (mesh.cell_region > 0).astype(np.int32)]
    return meshio.Mesh(points, [("line", mesh.facets[named]), ("triangle", mesh.cells)], cell_data={"group": groups})


def main() -> None:
    """Write all samples."""
    mesh = bracket()
    (FOLDER / "bracket.bdf").write_text(nastran(mesh))
    (FOLDER / "bracket.inp").write_text(abaqus(mesh))
    groups = tagged(mesh)
    meshio.write(FOLDER / "bracket.vtu", groups)
    tags = groups.cell_data["group"]
    groups.cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    names = {"clamp": (1, 1), "load": (2, 1), "bolt": (3, 1), "bracket": (10, 2), "corner": (11, 2)}
    groups.field_data = {name: np.array(tag) for name, tag in names.items()}
    meshio.write(FOLDER / "bracket.msh", groups, file_format="gmsh22", binary=False)


if __name__ == "__main__":
    main()
