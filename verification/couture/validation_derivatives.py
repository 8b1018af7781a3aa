"""Validation cases of derivatives of drapes: identities that hold for any cloth, with contact and friction."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.replay.loop import Replay

SCENES = application("couture").folder / "scenes"
COARSE = ["mesh.size=0.06", "mesh.levels=1", "effects.drape.tolerance=1e-9", "effects.contact.self=false"]
BALL, CONTACT, COTTON = "bodies.ball.sphere", "effects.contact", "material.cotton"
TOLERANCE = 1e-10
"""Of derivatives."""
BOUND = 1e-6
"""Of what is exact but for the rest and the solves, as a share of the largest of its parts."""


def drape_identities(comm: PETSc.Comm) -> list[Check]:
    """A square on a rough ball, moved with it and made of stiffer and heavier cloth, and a strip scaled with its ball.

    The strip has no friction: its anchors go with the material that a hand moves, not with the size of all.
    """
    checks = []
    for kind in ("morley", "hinge"):
        bending = f'effects.cloth.bending="{kind}"'
        square = first_frame(SCENES / "sphere.toml", [*COARSE, bending, "bodies.ball.friction=0.4"], comm)
        strip = first_frame(
            SCENES / "longer.toml", [*COARSE, bending, "bodies.ball.friction=0", "mesh.size=0.04"], comm
        )
        checks += _moved(square, kind) + _heavier(square, kind) + _larger(strip, kind)
    return checks


def _by(replay: Replay, *keys: str) -> list[np.ndarray]:
    """Derivatives (corners, 3) of the places of corners by numbers of the scene."""
    sheet = replay.analysis.problem
    return [sheet.corners(s) for s in replay.analysis.number_derivatives(keys, TOLERANCE).s]


def _moved(replay: Replay, kind: str) -> list[Check]:
    """Nothing but the ball holds the cloth: it takes it along, anchors of friction included."""
    found = _by(replay, *(f"{BALL}.center.{k}" for k in range(3)))
    off = max(float(np.abs(s - np.eye(3)[k]).max()) for k, s in enumerate(found))
    return [Check(f"{kind}: motion with the ball, off by", off, 0.0, BOUND, "a rigid motion", CLOSED_FORM)]


def _heavier(replay: Replay, kind: str) -> list[Check]:
    """Stiffness and weight that grow by the same share: all forces do, and the cloth stays."""
    cotton = replay.analysis.state.scene.material["cotton"]
    values = {"E": cotton.E, "rho": cotton.rho, "bending": cotton.bending}
    parts = [value * s for value, s in zip(values.values(), _by(replay, *(f"{COTTON}.{key}" for key in values)))]
    off = float(np.abs(sum(parts)).max() / max(np.abs(part).max() for part in parts))
    source = "equilibrium is homogeneous in all forces"
    return [Check(f"{kind}: stiffness and weight together, off by", off, 0.0, BOUND, source, CLOSED_FORM)]


def _larger(replay: Replay, kind: str) -> list[Check]:
    """k times as large, under 1/k of the weight and with k^2 times the bending stiffness: the same shape, k times."""
    analysis, scene = replay.analysis, replay.analysis.state.scene
    sheet, ball = analysis.problem, scene.bodies["ball"].form
    contact, gravity = analysis.state.plan.settings("contact"), analysis.state.plan.settings("gravity")
    factors = {f"{BALL}.center.{k}": value for k, value in enumerate(ball.center)}
    factors |= {f"{BALL}.radius": ball.radius, f"{CONTACT}.thickness": contact.thickness}
    factors |= {f"{COTTON}.bending": 2.0 * scene.material["cotton"].bending, "effects.gravity.g.2": -gravity.g[2]}
    parts = [factor * s for factor, s in zip(factors.values(), _by(replay, *factors))]
    parts.append(sheet.corners(analysis.derivative(sheet.mesh.X[None], TOLERANCE).s[0]))
    off = float(np.abs(sum(parts) - sheet.corners(analysis.x)).max() / max(np.abs(part).max() for part in parts))
    return [Check(f"{kind}: size, off by", off, 0.0, BOUND, "similar cloth has similar drapes", CLOSED_FORM)]
