"""Validation case of a large motion: a beam that gravity sets swinging."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import IDENTITY, PROGRAM, PUBLISHED, Check

from restshape.analysis.frame import Frame
from restshape.application import application
from restshape.interface.first_frame import first_frame

SCENES = application("vibration").folder / "scenes"
STEP = 0.005
"""The step of the reference [s]; four times as long, the motion gains energy without end."""
END = 10.0
"""The end of the motion [s]: cycles that begin later are left out."""
FIRST, LAST = (0.0, 0.93), (9.08, 10.0)
"""Times [s] of the first and of the last whole cycle."""


@each_week(END=1.0)
def csm3(comm: PETSc.Comm) -> list[Check]:
    """The first and the last cycle of Turek and Hron's beam; they differ, for the motion is not periodic."""
    replay = first_frame(SCENES / "csm3.toml", ["effects.dynamics.steps=1"], comm)
    analysis = replay.analysis
    unedited = Frame(analysis.space, np.empty(0, dtype=np.int32), None, analysis.state.scene, (None, (0.0, 0.0)))
    tip, energies = [[0.0, 0.0]], [0.0]
    for _ in range(round(END / STEP)):
        analysis.solve(unedited)
        tip.append([analysis.observe()[axis] for axis in "xy"])
        energies.append(analysis.total_energy())
    times, tip = STEP * np.arange(len(tip)), np.array(tip)
    published = "Turek and Hron 2006, CSM3: the cycle before t = 10 s"
    first = "converged solution on spectral elements, trapezoidal rule, dt = 0.005 s"
    wanted = [
        ("first", FIRST, 0.002, PROGRAM, first, ((-14.627e-3, 14.627e-3), (-64.852e-3, 64.779e-3))),
        ("last", LAST, 0.002, PUBLISHED, published, ((-14.305e-3, 14.305e-3), (-63.607e-3, 65.160e-3))),
    ]
    checks = []
    for cycle, (start, end), tolerance, kind, source, references in wanted:
        if start >= END:
            continue
        during = tip[(times >= start) & (times <= end)]
        for axis, values, (middle, swing) in zip("xy", during.T, references):
            most, least = values.max(), values.min()
            centre, half = f"{axis} in the middle, {cycle} cycle [m]", f"swing of {axis}, {cycle} cycle [m]"
            checks.append(Check(centre, (most + least) / 2, middle, tolerance, source, kind))
            checks.append(Check(half, (most - least) / 2, swing, tolerance, source, kind))
    drift = float(np.abs(energies).max())
    source = "gravity's work is the body's energy"
    return [*checks, Check("largest energy gained or lost [J]", drift, 0.0, 1e-4, source, IDENTITY)]
