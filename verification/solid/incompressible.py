"""Nearly incompressible bodies, on Cook's membrane in plane strain: what locks, and what does not."""

import argparse
from collections.abc import Iterable

from petsc4py import PETSc
from restshape_studies.validation.case import PROGRAM, Check

from restshape.application import application
from restshape.cli.options import add_json, print_table, write_json
from restshape.interface.first_frame import first_frame

SCENE = application("solid").folder / "scenes" / "cook.toml"
RUBBER = ("material.unit.nu=0.4999", "effects.solid.model=plane_strain")
V_MIDDLE = 18.527
"""Deflection [m] of (48, 52) by an independent p-FEM solution, E = 1; its third digit still moved."""

LOCKS = "order 1"
ELEMENTS = {
    LOCKS: ("mesh.order=1",),
    "order 2": ("mesh.order=2", "effects.solid.element=displacement"),
    "order 2, mean dilatation": (),
}
"""What the rows of the table set besides; without anything the plan decides."""


def table(
    sizes: tuple[float, ...], comm: PETSc.Comm, elements: Iterable[str] = ELEMENTS
) -> list[dict[str, float | int | str]]:
    """Rows element, size [m], unknowns, v [m] at (48, 52) and its error, one an element and size."""
    rows = []
    for element in elements:
        for size in sizes:
            row = first_frame(SCENE, [*RUBBER, *ELEMENTS[element], f"mesh.size={size}"], comm).row
            v = row["q_v_middle"]
            found = {"element": element, "size": size, "unknowns": row["unknowns"], "v": v, "error": v / V_MIDDLE - 1}
            rows.append(found)
    return rows


SIZES = (6.0, 3.0, 1.5, 0.75)
UNSURE, COARSE = 1e-3, 0.02
"""What the reference's last digits leave open, and the error that passes on triangles of 6 m, a wall of 44 m."""


def tolerance(size: float) -> float:
    """The error that passes on triangles of a size [m]: linear in it, as at the singular corner of the wall."""
    return UNSURE + COARSE * size / SIZES[0]


def incompressible(comm: PETSc.Comm) -> list[Check]:
    """Cook's membrane in plane strain at nu = 0.4999, by elements of second order: none of them locks."""
    source = "converged p-FEM, plane strain, E = 1, nu = 0.4999"
    checks = []
    for row in table(SIZES, comm, (element for element in ELEMENTS if element != LOCKS)):
        what = f"v at (48, 52), {row['element']}, size {row['size']:g}, {row['unknowns']} unknowns [m]"
        checks.append(Check(what, row["v"], V_MIDDLE, tolerance(row["size"]), source, PROGRAM))
    return checks


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print errors by element and size; 0."""
    rows = table(SIZES, PETSc.COMM_WORLD)
    heads = ("element", "size [m]", "unknowns", "v at (48, 52) [m]", "error")
    cells = [(r["element"], r["size"], r["unknowns"], f"{r['v']:.4f}", f"{r['error']:+.2%}") for r in rows]
    print_table("Cook's membrane, nu = 0.4999", heads, cells, right=heads[1:])
    write_json(args, rows)
    return 0
