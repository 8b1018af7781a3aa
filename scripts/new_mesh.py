"""What a new mesh does to the forces on the blunt body of `flow.toml`, by ways to take the past of the flow to it.

python scripts/new_mesh.py

Eddies leave the body; at four moments the mesh is made again, of another size. Printed are the largest changes of drag
and lift in the first step after, in the second and in the sixth, against the mesh of before: over the largest drag and
over the lift from peak to peak, then over the amplitudes, half from peak to peak. What the two meshes differ by, each
from the beginning, is printed below: it is part of all of them.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np
from restshape_apps.flow import application
from restshape_studies.stability.scenery import make_run, set_value, write_script

from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.mesh.transfer import Transfer
from restshape.physics.flow.carry import Carrier, VelocityCorrection

SCENE = application.folder / "scenes" / "flow.toml"
OTHER = "10.4 mm"
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


def forces(moment: int | None, size: str | None = None) -> np.ndarray:
    """Drag and lift (frames, 2), with a new mesh after so many frames, or with none; on one of a size throughout."""
    rest = max(MOMENTS) + RESTING + 1
    events: list[dict] = [{"do": "idle", "frames": moment or rest}]
    if moment:
        events += [*set_value("mesh.size", OTHER), {"do": "idle", "frames": RESTING}]
    with TemporaryDirectory() as folder:
        run = make_run(SCENE, write_script(Path(folder), events), overrides=[f"mesh.size={size}"] if size else [])
        return np.array([(row["q_drag"], row["q_lift"]) for row in run.rows()])


def main() -> None:
    """Print a row for each way."""
    kept = forces(None)
    swing = np.ptp(kept[70:], axis=0)
    sizes, amplitudes = np.array([kept[70:, 0].max(), swing[1]]), 0.5 * swing
    print(f"{'over the largest drag, and the lift from peak to peak':56}over half from peak to peak")
    print(f"{'':34}{'  drag: 1    2    6   lift: 1    2    6' * 2}")
    for name, how in WAYS.items():
        with changed(how):
            found = [(forces(at)[: len(kept)] - kept[: at + RESTING + 2])[at + 1 :] for at in MOMENTS]
        most = np.abs(np.array([one[[0, 1, 5]] for one in found])).max(axis=0)
        shown = [most / sizes, most / amplitudes]
        print(f"{name:34}" + "".join(f"{100 * v:6.1f}" for one in shown for v in one.T.ravel()), flush=True)
    apart = (forces(None, OTHER)[70:] - kept[70:])[:, 0].mean()
    share, part = 100 * abs(apart) / sizes[0], 100 * abs(apart) / amplitudes[0]
    print(f"the mean drag of both meshes differs by {share:.1f} % of the largest, {part:.0f} % of the amplitude")


if __name__ == "__main__":
    main()
