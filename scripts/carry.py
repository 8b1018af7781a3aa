"""What nodes that move should take along in a flow in time: `ale` beside `remap`, on a drag at several speeds.

python scripts/carry.py [SIZE ...]

A round body in a channel is dragged for one step, and for four, and rests for five more. Errors are those of the
velocity in these steps, over the velocity, in the mean square, and the largest of the drag [N], against steps an eighth
as long on the same moving mesh. SIZE is that of the mesh; without any, 0.12 and 0.06 m.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.scenery import write_scene
from restshape_verification.flow.scenes import channel, disc, in_time

from restshape.analysis.frame import Frame
from restshape.interface.first_frame import first_frame
from restshape.mesh.relocate import BoundaryNodes, HarmonicExtension
from restshape.physics.flow.carry import courant
from restshape.physics.flow.history import Level

STEP, SETTLING, RESTING, PARTS = 0.1, 20, 5, 8
ASKED = '[quantities]\ndrag = { drag = true, at = "body" }\n'


class Drag(NamedTuple):
    """Speed [m/s] of a drag along (1, 0.3), and its steps."""

    speed: float
    steps: int

    def place(self, time: float) -> float:
        """How far the body is [m] at a time [s] after the drag has begun."""
        return self.speed * min(max(time, 0.0), self.steps * STEP)


class Run(NamedTuple):
    """What a run found at the ends of the steps: velocities, drags, and the largest Courant number of the mesh."""

    velocities: np.ndarray
    drags: np.ndarray
    farthest: float


def run(carry: str, drag: Drag, size: float, parts: int = 1) -> Run:
    """The flow while the body is dragged, by steps that are each cut into parts."""
    body = disc("body", (1.0, 0.5), 0.15)
    text = channel(3.0, 1.0, "rho = 1\nmu = 0.01\n", holes=body) + in_time(STEP / parts, carry=carry) + ASKED
    with TemporaryDirectory() as folder:
        mesh = f"[mesh]\nsize = {size!r}\nnear = {{ body = {size / 2.4!r} }}\n"
        analysis = first_frame(write_scene(Path(folder), text + mesh), [], PETSc.COMM_WORLD).analysis
    space, scene, X = analysis.space, analysis.state.scene, analysis.space.X.copy()
    nodes = BoundaryNodes(space).nodes
    on_body = np.linalg.norm(X[nodes] - [1.0, 0.5], axis=1) < 0.3
    along = HarmonicExtension(space, nodes).adapted(on_body[:, None] * np.array([1.0, 0.3]) / np.hypot(1.0, 0.3))
    velocities, drags, farthest = [], [], 0.0
    for k in range(1, (SETTLING + drag.steps + RESTING) * parts + 1):
        now = X + drag.place((k / parts - SETTLING) * STEP) * along
        farthest = max(farthest, courant(Level(analysis.x, space.X.copy(), space.cells), now))
        space.geometry += not np.array_equal(now, space.X)
        space.X[:] = now
        analysis.solve(Frame(space, np.empty(0, np.int32), None, scene, (None, (0.0, 0.0))))
        if k % parts == 0 and k > SETTLING * parts:
            velocities.append(analysis.x[:, :2].copy())
            drags.append(analysis.observe()["drag"])
    return Run(np.array(velocities), np.array(drags), farthest)


def main() -> None:
    """Print a row for each drag."""
    print("size [m]  steps  m/s   Courant   velocity: ale   remap   drag: ale   remap")
    for size in [float(word) for word in sys.argv[1:]] or [0.12, 0.06]:
        for drag in [*(Drag(v, 1) for v in (0.25, 0.5, 1.0, 2.0, 3.0)), *(Drag(v, 4) for v in (0.25, 0.5, 0.75))]:
            fine = run("ale", drag, size, PARTS)
            ale, remap = (run(carry, drag, size) for carry in ("ale", "remap"))
            norm = np.linalg.norm(fine.velocities)
            off = [np.linalg.norm(one.velocities - fine.velocities) / norm for one in (ale, remap)]
            forces = [np.abs(one.drags - fine.drags).max() for one in (ale, remap)]
            print(
                f"{size:8g} {drag.steps:6d} {drag.speed:5g} {ale.farthest:9.1f}"
                f"   {off[0]:13.4f} {off[1]:7.4f}   {forces[0]:9.3f} {forces[1]:7.3f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
