"""The thesis's numbers of cloth beside ours: figure 5.16, table 5.1, cloth on a ball."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from time import process_time
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_verification.couture.step_solvers import Compared, methods, table
from restshape_verification.couture.thesis_edits import edit_rows

from restshape.algebra.nonlinear.kinetic_damping import KineticDamping, Steps
from restshape.algebra.stages import Stages
from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations

SCENES = application("couture").folder / "scenes"
FIGURE, TABLE, SOLVERS, BALL = "figure 5.16", "5.1", "5.1, solvers", "figure 5.21"
HINGE, MORLEY = "effects.cloth.bending=hinge", "effects.cloth.bending=morley"
TURNS = 3
"""Runs of which the median is taken."""
LENGTHS, WARM, STEPS, FALLS = {"1/60": 1.0 / 60.0, "1/200": 1.0 / 200.0}, 20, 20, 5
"""Implicit steps: their lengths [s], for the thesis does not report its own; how many go before, how many are timed,
and in how many falls. Steps of one length, whose energy nothing looks at, diverge where much cloth hits the ball."""


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
ALONE = "effects.contact.self=false"
"""The programs that falling cloth is held against have no contact of cloth with itself."""
STEP_TOLERANCES = (Steps().tolerance, 1e-6)
SIZES = {"coarse": ("19.5 mm", "17.4 to 25.1"), "fine": ("7.83 mm", "2.4 to 3.1")}
"""Mesh sizes for about 1,650 and 10,000 nodes, and the thesis's steps a second there."""
SOLVER_SIZES, COMPARED = {"coarse": "20.9 mm", "fine": "7.9 mm"}, 17
"""Mesh sizes for about 1,500 and 9,800 nodes, and steps, some of which solvers are compared on."""


@each_week()
def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`."""
    found = [row for benchmark in BENCHMARKS for row in benchmark_rows(benchmark, timed)]
    return [*found, *((*step_rows(), *edit_rows(), *solver_rows(), *ball_rows()) if timed else ())]


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
        cloth = Falling(size)
        for words, length in LENGTHS.items():
            for tolerance in STEP_TOLERANCES:
                quantity = f"implicit steps of {words} s, solved to {tolerance:g}"
                common = {"table": TABLE, "row": f"{name} mesh of {cloth.nodes:,} nodes, hinges"}
                found.append(_timing(common, quantity, speed, cloth.stepped(length, tolerance), "1/s"))
    return found


def solver_rows() -> list[dict[str, Any]]:
    """Iterations and time of solvers on the same systems of steps, from no guess, set-up included."""
    found = []
    for name, size in SOLVER_SIZES.items():
        cloth = Falling(size)
        for row, tolerance, iterations, ms in cloth.compared(LENGTHS["1/200"]):
            common = {"table": SOLVERS, "row": f"{name} mesh of {cloth.nodes:,} nodes, {row}"}
            quantity = f"a step of 1/200 s, solved to {tolerance:g}"
            found.append(_timing(common, f"{quantity}: iterations", "", iterations, "iterations"))
            found.append(_timing(common, quantity, "", ms, "ms"))
    return found


class Stepped:
    """Cloth from a state that implicit steps start at.

    Args:
        sheet: the cloth; start: (n, 3) its positions [m].
        checked: steps that gain energy are taken back, and made shorter.

    Attributes:
        nodes: of the mesh.
    """

    def __init__(self, sheet: ClothProblem, start: np.ndarray, checked: bool = False) -> None:
        self.sheet, self.start, self.checked = sheet, start, checked
        self.friction = self.sheet.contact.history
        self.nodes = len(self.sheet.mesh.X)

    def stepped(self, length: float, tolerance: float, steps: int = STEPS) -> float:
        """Implicit steps with kinetic damping a second of the processor.

        Args:
            length: of the steps [s].
            tolerance: that their systems are solved to.
            steps: that are timed.
        """
        taken = []
        for _ in range(FALLS):
            times: list[float] = []
            moving, _ = self._moving(length, tolerance, WARM + steps)
            moving.on_step = lambda x, norm, times=times: times.append(process_time())
            self._run(moving)
            taken += np.diff(times)[WARM:].tolist()
        return len(taken) / sum(taken)

    def compared(self, length: float, steps: int = COMPARED) -> list[tuple[str, float, float, float]]:
        """What `step_solvers.table` has of so many steps of a length [s]."""
        moving, equations = self._moving(length, STEP_TOLERANCES[-1], WARM + steps)
        hierarchy = self.sheet.mesh.hierarchy
        found = methods(hierarchy.steps if hierarchy else ())
        moving.on_step = Compared(moving, equations, found, WARM).note
        self._run(moving)
        return table(found)

    def _moving(self, length: float, tolerance: float, most: int) -> tuple[KineticDamping, ClothEquations]:
        self.sheet.contact.history = self.friction
        equations = ClothEquations(self.sheet, PETSc.COMM_SELF, Stages())
        longest = np.nextafter(length, 1.0) if self.checked else length
        even = Steps(length, longest=longest, most=most, tolerance=tolerance)
        shape = self.start.shape
        moving = KineticDamping(PETSc.COMM_SELF, "steps_", equations, equations.mass, shape, equations.rows, even)
        moving.on_move = self.sheet.follow_friction
        return moving, equations

    def _run(self, moving: KineticDamping) -> None:
        moving.run(self.start.copy(), 0.0)
        moving.free()


class Falling(Stepped):
    """The dress's cloth as it falls on the ball.

    Args:
        size: of the mesh.
    """

    def __init__(self, size: str) -> None:
        # One step of the scene's way: what is wanted is the cloth, with all that its steps need.
        first = (HINGE, DRESS, ALONE, f'mesh.size="{size}"', "effects.drape.strategy=kinetic", "effects.drape.steps=1")
        analysis: RelaxationAnalysis = first_frame(SCENES / "sphere.toml", first).analysis
        super().__init__(analysis.problem, analysis.x)


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
