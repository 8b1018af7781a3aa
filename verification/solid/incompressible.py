"""Nearly incompressible bodies, on Cook's membrane in plane strain: what locks, and what does not."""

from petsc4py import PETSc
from restshape_studies.validation.case import Check

from restshape.application import application
from restshape.replay.first_frame import first_frame

SCENE = application("solid").folder / "scenes" / "cook.toml"
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
            row = first_frame(SCENE, [*RUBBER, *overrides, f"mesh.size={size}"], comm).row
            v = row["q_v_middle"]
            found = {"element": element, "size": size, "unknowns": row["unknowns"], "v": v, "error": v / V_MIDDLE - 1}
            rows.append(found)
    return rows


SIZES = (6.0, 3.0, 1.5, 0.75)
TOLERANCES = {
    "order 1": (0.4, 0.35, 0.2, 0.08),
    "order 2": (0.015, 0.007, 0.004, 0.0025),
    "order 2, mean dilatation": (0.015, 0.004, 0.002, 0.002),
}
"""Errors that pass, by size: of order 1, which locks, so large that they only say how much."""


def incompressible(comm: PETSc.Comm) -> list[Check]:
    """Cook's membrane in plane strain at nu = 0.4999, by element: the one that the plan picks locks on no mesh."""
    source = "converged p-FEM, plane strain, E = 1, nu = 0.4999"
    checks = []
    for row in table(SIZES, comm):
        element, size = row["element"], row["size"]
        kind = f"{element}, which locks" if element == "order 1" else element
        what = f"v at (48, 52), {kind}, size {size:g}, {row['unknowns']} unknowns [m]"
        checks.append(Check(what, row["v"], V_MIDDLE, TOLERANCES[element][SIZES.index(size)], source))
    return checks
