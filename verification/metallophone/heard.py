"""Validation of what is heard: the tone of a drag by its zero crossings, and how fast a blow dies away."""

import json
from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc
from restshape_apps.metallophone.sounding import drag
from restshape_apps.metallophone.sounding.blow import struck
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.wav import RATE
from restshape_studies.validation.case import CLOSED_FORM, PROGRAM, Check
from restshape_verification.metallophone.reference import SCENES, solved

from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import read_script
from restshape.scene.load import load_scene

PLATE = ("effects.modal.model=plate", "effects.modal.modes=1", "mesh.order=1")
LENGTHS = {0.2: 523.31, 0.15: 930.03, 0.1: 2089.35}
"""Frequencies [Hz] of free bars of aluminium L x 30 x 4 mm, by L [m]: p-FEM of three-dimensional elasticity."""
FRAMES, PERIODS = 60, 6
"""Of the drag from the longest to the shortest, and over which a frequency is measured."""
LOSS = 0.02


def heard(comm: PETSc.Comm) -> list[Check]:
    """The tone of a bar that is halved, as a sine in its sound; the logarithmic decrement of a blow."""
    frames = _frames(comm)
    samples, begin = drag.sine(frames), frames[0].t
    # At rest at both ends; on the way, half of the frames after the first step, it has the length between.
    moments = {0.2: 0.05, 0.15: 0.1 + (FRAMES / 2 - 1) / 60.0, 0.1: 0.1 + FRAMES / 60.0 + 0.05}
    checks = [
        Check(
            f"tone of the drag at {1e3 * length:.0f} mm [Hz]",
            _pitch(samples, moments[length] - begin),
            reference,
            5e-3,
            "p-FEM of 3D elasticity",
            PROGRAM,
        )
        for length, reference in LENGTHS.items()
    ]
    return [*checks, _decrement(comm)]


def _frames(comm: PETSc.Comm) -> Sequence[drag.ModesAt]:
    """The modes in each frame of the drag, in which the right end goes evenly to the left."""
    path = SCENES / "bar_200.toml"
    scene = load_scene(path, PLATE)
    last = 0.1 + FRAMES / 60.0
    lines = [
        {"format": "restshape-edits", "version": 1, "scene": path.name},
        {"t": 0.0, "do": "press", "on": "right", "at": [0.2, 0.015]},
        {"t": 0.1, "do": "drag", "to": [0.1, 0.015], "frames": FRAMES},
        {"t": last, "do": "release"},
        {"t": last + 0.1, "do": "idle", "frames": 1},
    ]
    script = read_script("\n".join(map(json.dumps, lines)) + "\n", path, scene)
    run = Run(Request.of(scene, script), summed=False, comm=comm)
    times = (float(row["t"]) for row in run.rows())
    rows = [(t, drag.modes_at(run.replay.analysis, t, None, None)) for t in times]
    return drag.in_order([frame for _, frame in rows], rows[0][0], rows[-1][0])


def _pitch(samples: np.ndarray, moment: float) -> float:
    """The frequency [Hz] of samples around a moment [s], by the zero crossings of some periods."""
    k = np.flatnonzero((samples[:-1] < 0.0) & (samples[1:] >= 0.0))
    at = (k + samples[k] / (samples[k] - samples[k + 1])) / RATE
    middles, pitches = 0.5 * (at[PERIODS:] + at[:-PERIODS]), PERIODS / (at[PERIODS:] - at[:-PERIODS])
    return float(np.interp(moment, middles, pitches))


def _decrement(comm: PETSc.Comm) -> Check:
    """The logarithmic decrement of a blow on a bar of a loss factor, by peaks that are 50 periods apart."""
    bar = solved("bar_200.toml", comm, [*PLATE, f"material.aluminium.loss_factor={LOSS}"])
    f = float(bar.frequencies[0])
    samples = np.abs(struck(bar.frequencies, np.ones(1), damping_of(bar).shares, 0.2, 1e-3))
    period = RATE / f
    early, late = (samples[round(n * period) : round((n + 1) * period)].max() for n in (10, 60))
    source = "pi times the loss factor"
    return Check(
        "logarithmic decrement of a blow", float(np.log(early / late) / 50.0), np.pi * LOSS, 1e-3, source, CLOSED_FORM
    )
