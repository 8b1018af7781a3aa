"""Validation cases of cloth that is clamped at one end and hangs: the heavy elastica."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import meshio
import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.replay.loop import Replay

STRIP = application("couture").folder / "scenes" / "strip.toml"
LENGTH, WIDTH = 0.05, 0.0125
LOAD = 0.3 * 9.81 * LENGTH**3
"""w L^3 of strip.toml [N m], for each width."""

ELASTICA = {
    1: (0.991246, 0.123471, 9.460425),
    8: (0.724425, 0.640631, 53.864996),
    100: (0.159223, 0.937524, 89.616748),
    1000: (0.045986, 0.981141, 90.0),
}
"""By Gamma = w L^3/(EI): how far the tip is beside the clamp [L], and below it [L], and its angle [degrees]."""
SLOPES = {1: (-0.017166, 0.120480), 8: (-0.036907, 0.035546), 100: (-0.000943, 0.000338)}
"""Derivatives of the first two with respect to Gamma."""
SOURCE = "heavy elastica: EI theta'' = -w (L - s) cos theta"
MIRRORED = "supports={{clamp={{{}}},bottom={{{}}},top={{{}}}}}".format(
    'on="left",fix=["x","y","z","slope"]', 'on="bottom",symmetry="y"', 'on="top",symmetry="y"'
)
"""Override: the strip is part of a wide plate."""

NARROW = [
    'material.canvas.E="0.4 MPa"',
    'mesh.size="0.8 mm"',
    f"shape.vertices.c=[{LENGTH},{WIDTH / 4}]",
    f"shape.vertices.d=[0,{WIDTH / 4}]",
]
"""Overrides: narrow, and stretching so easily that it may curve across too."""

NEAR = 0.01
"""Part of the length by which a tip may be off where it is bent sharply."""


def near(gamma: float) -> float:
    """Part of the length by which a tip may be off: as the square of mesh size over the bend's radius L/Gamma^(1/3)."""
    return min(NEAR, 1e-3 * gamma ** (2 / 3))


def tip(replay: Replay) -> tuple[float, float, float]:
    """Place of the tip beside and below the clamp [L], and its angle [degrees]."""
    sheet, x = replay.analysis.problem, replay.analysis.x
    right = sheet.mesh.X[:, 0] > LENGTH * (1 - 1e-6)
    away, _, up = sheet.corners(x)[right].mean(axis=0) / LENGTH
    return float(away), float(-up), angle(replay) if sheet.morley else float("nan")


def angle(replay: Replay) -> float:
    """The angle below the horizon of a strip of Morley's triangles at its end [degrees], from the slopes there."""
    sheet = replay.analysis.problem
    ends = sheet.mesh.X[sheet.mesh.edge_nodes, 0]
    slopes = replay.analysis.x[sheet.morley.side_number[(ends > LENGTH * (1 - 1e-6)).all(axis=1)]]
    # An edge's own normal may point either way along the strip; here its end is never turned back.
    away, _, up = np.abs(slopes).mean(axis=0)
    return float(np.degrees(np.arctan2(up, away)))


def bent(gamma: float, overrides: Sequence[str], comm: PETSc.Comm, path: Path = STRIP) -> Replay:
    """The strip in equilibrium under a weight Gamma, for D."""
    return first_frame(path, [f"material.canvas.bending={LOAD / gamma!r}", *overrides], comm)


def rows(what: str, gamma: float, found: tuple[float, float, float]) -> list[Check]:
    """A tip's place, each coordinate within a part of the length, and its angle while that reports something."""
    exact = ELASTICA[gamma]
    checks = [
        Check(f"{what}Gamma = {gamma}: {name}", value, ref, min(0.1, near(gamma) / ref), SOURCE, CLOSED_FORM)
        for name, value, ref in zip(("W/L", "H/L"), found, exact)
    ]
    if gamma <= 8:
        angle = f"{what}Gamma = {gamma}: angle of the tip [deg]"
        checks.append(Check(angle, found[2], exact[2], near(gamma), SOURCE, CLOSED_FORM))
    return checks


def off(found: tuple[float, float, float], gamma: float) -> float:
    """How far a tip is from the elastica's [L]."""
    return float(np.hypot(found[0] - ELASTICA[gamma][0], found[1] - ELASTICA[gamma][1]))


def cantilever(comm: PETSc.Comm) -> list[Check]:
    """Strips of Morley's triangles with Gamma from 1 to 1000, on unstructured and on equilateral triangles."""
    checks = []
    for gamma in ELASTICA:
        checks += rows("", gamma, tip(bent(gamma, (), comm)))
    with TemporaryDirectory() as folder:
        path = equilateral(Path(folder), 40)
        for gamma in ELASTICA:
            found = tip(bent(gamma, (), comm, path))
            what = f"equilateral, Gamma = {gamma}: off the tip [L]"
            checks.append(Check(what, off(found, gamma), 0.0, near(gamma), SOURCE, CLOSED_FORM))
    return checks


def wide_cantilever(comm: PETSc.Comm) -> list[Check]:
    """What stiffness counts with nu = 0.3: D of a plate so wide that nothing contracts, EI of a narrow strip."""
    checks = []
    clamped = ["material.canvas.nu=0.3", MIRRORED]
    for gamma in (8, 100):
        found = tip(bent(gamma, clamped, comm))
        checks += rows("wide plate by D: ", gamma, found)
    for gamma in (8, 100):
        # D (1 - nu^2) is EI by width.
        found = tip(bent((1 - 0.3**2) * gamma, ["material.canvas.nu=0.3", *NARROW], comm))
        checks += rows("narrow strip by EI: ", gamma, found)
    return checks


def cantilever_derivative(comm: PETSc.Comm) -> list[Check]:
    """How the tip follows Gamma, by the derivatives of the drape with respect to its stiffness and to its weight."""
    checks = []
    for gamma, slopes in SLOPES.items():
        replay = bent(gamma, (), comm)
        keys = ["material.canvas.bending", "effects.gravity.g.2"]
        sheet, found = replay.analysis.problem, replay.analysis.number_derivatives(keys, 1e-8)
        right = sheet.mesh.X[:, 0] > LENGTH * (1 - 1e-6)
        scene = replay.analysis.state.scene
        # Gamma is proportional to the weight, and to one over the stiffness.
        for what, s, factor in (
            ("stiffness", found.s[0], -scene.material["canvas"].bending / gamma),
            ("weight", found.s[1], replay.analysis.state.plan.settings("gravity").g[2] / gamma),
        ):
            away, _, up = factor * sheet.corners(s)[right].mean(axis=0) / LENGTH
            for name, value, exact in zip(("W/L", "H/L"), (away, -up), slopes):
                label = f"Gamma = {gamma}: d({name})/d(Gamma) by the {what}"
                checks.append(Check(label, value, exact, 5e-3 if gamma <= 8 else 4 * NEAR, SOURCE, CLOSED_FORM))
    return checks


def hinged_cantilever(comm: PETSc.Comm) -> list[Check]:
    """How far hinges are off: as a wide plate, as a narrow strip, and as a strip for which neither factor holds."""
    checks = []
    with TemporaryDirectory() as folder:
        for name, path, settings, bound in (
            ("plate", STRIP, ["effects.cloth.hinges=plate", MIRRORED], NEAR),
            ("plate, equilateral", equilateral(Path(folder), 40), ["effects.cloth.hinges=plate", MIRRORED], NEAR),
            ("narrow strip", STRIP, ["effects.cloth.hinges=strip", *NARROW], 2 * NEAR),
            ("strip of L/4, kept straight across by its membrane", STRIP, ["effects.cloth.hinges=strip"], 6 * NEAR),
        ):
            for gamma in ELASTICA:
                found = tip(bent(gamma, ["effects.cloth.bending=hinge", *settings], comm, path))
                quantity = f"hinges, {name}, Gamma = {gamma}: off the tip [L]"
                checks.append(Check(quantity, off(found, gamma), 0.0, bound, SOURCE, CLOSED_FORM))
    return checks


def equilateral(folder: Path, rows: int) -> Path:
    """A scene like strip.toml, written to a folder, on equilateral triangles with a side across the strip.

    Args:
        folder: for the scene and its mesh.
        rows: of triangles along the strip, an even number.
    """
    step = LENGTH / rows
    side = 2.0 * step / np.sqrt(3.0)
    columns = round(WIDTH / side)
    X, start = [], []
    for row in range(rows + 1):
        y = np.arange(columns + 1) * side
        if row % 2:
            # Triangles at the sides are halved there.
            y = np.concatenate([[0.0], y[:-1] + side / 2, [columns * side]])
        start.append(sum(map(len, X)))
        X.append(np.column_stack([np.full(len(y), row * step), y, 0.0 * y]))
    cells = []
    for row in range(rows):
        even, odd = (start[row], start[row + 1]) if row % 2 == 0 else (start[row + 1], start[row])
        cells += [(even + i, even + i + 1, odd + i + 1) for i in range(columns)]
        cells += [(even + i, odd + i + 1, odd + i) for i in range(columns + 1)]
    first, last = np.array(start), np.array([*start[1:], sum(map(len, X))]) - 1
    end = np.column_stack([np.arange(columns), np.arange(1, columns + 1)])
    sides = [end, start[-1] + end, *(np.column_stack([row[:-1], row[1:]]) for row in (first, last))]
    tags = [np.repeat([1, 2, 3, 4], [len(side) for side in sides]), np.full(len(cells), 5)]
    names = {name: np.array([k, 1]) for k, name in enumerate(("left", "right", "bottom", "top"), 1)}
    meshio.write(
        folder / "strip.msh",
        meshio.Mesh(
            np.vstack(X),
            [("line", np.vstack(sides)), ("triangle", np.array(cells))],
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data={**names, "canvas": np.array([5, 2])},
        ),
        file_format="gmsh22",
        binary=False,
    )
    text = STRIP.read_text()
    head, _, rest = text.partition("[shape]")
    kept = rest[rest.index("[material.canvas]") :].partition("[quantities]")[0]
    path = folder / "strip.toml"
    path.write_text(head + kept.replace('size = "1.5625 mm"', f'file = "strip.msh"\nsize = {side}'))
    return path
