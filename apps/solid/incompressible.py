"""Nearly incompressible bodies, on Cook's membrane in plane strain: what locks, and what does not."""

from pathlib import Path

from petsc4py import PETSc

from restshape.replay.still import still
from restshape.validation.case import Check

SCENE = Path(__file__).parent / "scenes" / "cook.toml"
RUBBER = ("material.unit.nu=0.4999", "effects.solid.model=plane_strain")
V_MIDDLE = 18.527
"""Deflection [m] of (48, 52) by an independent p-FEM solution, E = 1; its third digit still moved."""

ELEMENTS = {
    "order 1": ("mesh.order=1",),
    "order 2": ("mesh.order=2", "effects.solid.element=displacement"),
    "order 2, mean dilatation": (),
}
"""What the rows of the table set besides; without anything the plan decides."""


def table(sizes: tuple[float, ...], comm: PETSc.Comm) -> list[dict[str, float | int | str]]:
    """Rows element, size [m], unknowns, v [m] at (48, 52) and its error, one an element and size."""
    rows = []
    for element, overrides in ELEMENTS.items():
        for size in sizes:
            row = still(SCENE, [*RUBBER, *overrides, f"mesh.size={size}"], comm).row
            v = row["q_v_middle"]
            found = {"element": element, "size": size, "unknowns": row["unknowns"], "v": v, "error": v / V_MIDDLE - 1}
            rows.append(found)
    return rows


def incompressible(comm: PETSc.Comm) -> list[Check]:
    """Cook's membrane in plane strain at nu = 0.4999: the element that the plan picks does not lock on any mesh."""
    source, checks = "converged p-FEM, plane strain, E = 1, nu = 0.4999", []
    for size, tolerance in ((8, 0.03), (4, 0.01), (2, 0.005), (1, 0.005)):
        row = still(SCENE, [*RUBBER, f"mesh.size={size}"], comm).row
        what = f"v at (48, 52), mean dilatation, {row['unknowns']} unknowns [m]"
        checks.append(Check(what, row["q_v_middle"], V_MIDDLE, tolerance, source))
    return checks
