"""The thesis's numbers of cloth beside ours: figure 5.16, implicit steps a second of table 5.1, cloth on a ball."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape.algebra.kinetic_damping import KineticDamping, Steps
from restshape.algebra.stages import Stages
from restshape.application import application
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations
from restshape.replay.first_frame import first_frame

SCENES = application("couture").folder / "scenes"
FIGURE, TABLE, BALL = "figure 5.16", "5.1", "figure 5.21"
HINGE, MORLEY = "effects.cloth.bending=hinge", "effects.cloth.bending=morley"
TURNS = 3
"""Runs of which the median is taken."""
LENGTHS, WARM, STEPS = {"1/60": 1.0 / 60.0, "1/200": 1.0 / 200.0}, 20, 100
"""Implicit steps: their lengths [s], for the thesis does not report its own; how many go before, how many are timed."""


@dataclass(frozen=True)
class Benchmark:
    """Cloth that is relaxed to equilibrium from random positions.

    Args:
        row: in the table.
        scene: of this application.
        triangles, seconds: of the thesis.
    """

    row: str
    scene: str
    triangles: int
    seconds: float


BENCHMARKS = (
    Benchmark("textile from random positions", "random", 3000, 12.0),
    Benchmark("plate 100 times as stiff from random positions", "stiff", 2000, 4.0),
)
DRESS = 'material.cotton.E="66.7 kPa"'
"""Stretches by 1 at 20 N/m, as the dress in the thesis's table 5.1; its weight and bending are the scene's."""
SIZES = {"coarse": ("19.5 mm", "17.4 to 25.1"), "fine": ("7.83 mm", "2.4 to 3.1")}
"""Mesh sizes for about 1,650 and 10,000 nodes, and the thesis's steps a second there."""


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`."""
    found = [row for benchmark in BENCHMARKS for row in benchmark_rows(benchmark, timed)]
    return [*found, *((*step_rows(), *ball_rows()) if timed else ())]


def benchmark_rows(benchmark: Benchmark, timed: bool) -> list[dict[str, Any]]:
    """Triangles, that it rests and stays, and the time of it."""
    common = {"table": FIGURE, "row": benchmark.row}
    seconds, last = rested(benchmark.scene, (), timed)
    counted = (("triangles", benchmark.triangles, last["elements"], "triangles"), _stays(last))
    return [*(_counted(common, *one) for one in counted), *_seconds(common, benchmark.seconds, seconds)]


def ball_rows() -> list[dict[str, Any]]:
    """Cloth on a ball: that it rests and stays, and the time of it, by kinds of bending and numbers of meshes."""
    found = []
    for kind, bending in (("hinges", HINGE), ("Morley's triangles", MORLEY)):
        for levels in (1, 3):
            common = {"table": BALL, "row": f"square cloth on a ball, {kind}, {levels} mesh{'es' * (levels > 1)}"}
            seconds, last = rested("sphere", (bending, f"mesh.levels={levels}"), True)
            found += [_timing(common, *_stays(last)), *_seconds(common, "", seconds)]
    return found


def rested(scene: str, overrides: Sequence[str], timed: bool) -> tuple[list[float], dict[str, Any]]:
    """Seconds of the first frame of a scene, mesh and all, run by run, and its row."""
    found = [first_frame(SCENES / f"{scene}.toml", overrides).row for _ in range(TURNS if timed else 1)]
    return [row["ms"] / 1e3 for row in found] if timed else [], found[-1]


def step_rows() -> list[dict[str, Any]]:
    """Implicit steps a second of a dress's cloth that falls over a ball, hinges, on a coarse and a fine mesh."""
    found = []
    for name, (size, speed) in SIZES.items():
        for words, length in LENGTHS.items():
            nodes, steps = stepped(size, length)
            row = f"{name} mesh of {nodes:,} nodes, hinges"
            quantity = f"implicit steps of {words} s, solved to {Steps().tolerance:g}"
            found.append(_timing({"table": TABLE, "row": row}, quantity, speed, steps, "1/s"))
    return found


def stepped(size: str, length: float, steps: int = STEPS) -> tuple[int, float]:
    """Nodes of a mesh of the cloth on a ball, and implicit steps with kinetic damping a second on it.

    Args:
        size: of the mesh.
        length: of the steps [s].
        steps: that are timed.
    """
    # One step of the scene's way: what is wanted is the cloth, with all that its steps need.
    first = (HINGE, DRESS, f'mesh.size="{size}"', "effects.drape.strategy=kinetic", "effects.drape.steps=1")
    analysis: RelaxationAnalysis = first_frame(SCENES / "sphere.toml", first).analysis
    sheet = analysis.problem
    equations = ClothEquations(sheet, PETSc.COMM_SELF, Stages())
    even = Steps(length, longest=length, most=WARM + steps)
    shape, rows = analysis.x.shape, equations.rows
    moving = KineticDamping(PETSc.COMM_SELF, "steps_", equations, equations.mass, shape, rows, even)
    times: list[float] = []

    def note(x: np.ndarray, norm: float) -> bool:
        times.append(perf_counter())
        return False

    moving.on_step = note
    moving.on_move = sheet.follow_friction
    moving.run(analysis.x.copy(), 0.0)
    moving.free()
    taken = np.diff(times)[WARM:]
    return len(sheet.mesh.X), len(taken) / float(taken.sum())


def _stays(row: dict[str, Any]) -> tuple[str, str, str, str]:
    stays = row["converged"] and row["tangent_positive_definite"] == 1
    return ("at rest, with a tangent that is positive definite", "", "yes" if stays else "no", "")


def _counted(common: dict[str, Any], quantity: str, thesis: Any, ours: Any, unit: str) -> dict[str, Any]:
    return {**common, "quantity": quantity, "thesis": thesis, "ours": ours, "unit": unit, "timing": False}


def _timing(common: dict[str, Any], quantity: str, thesis: Any, ours: Any, unit: str) -> dict[str, Any]:
    return {**_counted(common, quantity, thesis, ours, unit), "timing": True}


def _seconds(common: dict[str, Any], thesis: Any, seconds: list[float]) -> list[dict[str, Any]]:
    """The row of the time, where it was taken."""
    return [_timing(common, "time to rest", thesis, median(seconds), "s")] if seconds else []
