"""What a new mesh does to the forces on the blunt body of `flow.toml`, by ways to take the past of the flow to it.

python scripts/new_mesh.py

Eddies leave the body; at four moments the mesh is made again, of another size. Printed are the largest changes of drag
and lift in the first step after and in the second, over the largest drag and over the lift from peak to peak, against
the mesh of before. The difference of the two meshes, which is in the last column, is part of them.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np
from restshape_apps.flow import application
from restshape_studies.stability.scenery import make_replay, set_value, write_script

from restshape.algebra.newton_convergence import Outcome
from restshape.mesh.transfer import Transfer
from restshape.physics.flow.carry import Carrier, VelocityCorrection

SCENE = application.folder / "scenes" / "flow.toml"
MOMENTS, RESTING = (85, 92, 100, 108), 8
WAYS = {
    "interpolated, first order": {"linear", "first", "uncorrected"},
    "no divergence, first order": {"linear", "first", "no divergence"},
    "divergence of before, first order": {"linear", "first"},
    "both past velocities": {"linear"},
    "with curvature, as it is": set(),
}


def first_order(carrier: Carrier, *given: object) -> tuple:
    """What a carrier gives, without the level before the last one."""
    x, past, outcome = TAKE(carrier, *given)
    return x, past if outcome is None else replace(past, before=None), outcome


def uncorrected(correction: VelocityCorrection, level: object, wanted: object, time: float) -> tuple:
    """No correction."""
    return Outcome(True, 0, 0, False, True), level


def without_divergence(correction: VelocityCorrection, level: object, wanted: np.ndarray, time: float) -> tuple:
    """A correction that leaves none."""
    return CORRECT(correction, level, 0.0 * wanted, time)


TAKE, CORRECT = Carrier.__call__, VelocityCorrection.__call__


@contextmanager
def changed(how: set[str]) -> Iterator[None]:
    """Take the past to new meshes in one of the ways, for as long as this lasts."""
    correct = {"uncorrected": uncorrected, "no divergence": without_divergence}
    with (
        patch.object(Carrier, "__call__", first_order if "first" in how else TAKE),
        patch.object(VelocityCorrection, "__call__", next((correct[one] for one in correct if one in how), CORRECT)),
        patch.object(Transfer, "curved", Transfer.__call__ if "linear" in how else Transfer.curved),
    ):
        yield


def forces(moment: int | None) -> np.ndarray:
    """Drag and lift (frames, 2), with a new mesh after so many frames, or with none."""
    rest = max(MOMENTS) + RESTING + 1
    events: list[dict] = [{"do": "idle", "frames": moment or rest}]
    if moment:
        events += [*set_value("mesh.size", "10.4 mm"), {"do": "idle", "frames": RESTING}]
    with TemporaryDirectory() as folder:
        made = make_replay(SCENE, write_script(Path(folder), events))
        return np.array([(row["q_drag"], row["q_lift"]) for row in made.frames()])


def main() -> None:
    """Print a row for each way."""
    kept = forces(None)
    amplitude = np.array([kept[70:, 0].max(), np.ptp(kept[70:, 1])])
    print(f"{'':34}  drag: first   second   settled   lift: first   second   settled")
    for name, how in WAYS.items():
        with changed(how):
            found = [(forces(at)[: len(kept)] - kept[: at + RESTING + 2])[at + 1 :] for at in MOMENTS]
        most = np.abs(np.array([one[[0, 1, 5]] for one in found])).max(axis=0) / amplitude
        print(f"{name:34}" + "".join(f"{100 * v:10.1f} %" for v in most.T.ravel()), flush=True)


if __name__ == "__main__":
    main()
