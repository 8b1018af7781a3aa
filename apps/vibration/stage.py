"""What the tools of this application share: the shape of a frame, its modes, and where motions are looked at."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restshape.analysis.motion.transient import TransientAnalysis
from restshape.cli.options import add_scene
from restshape.cli.parser import add_edits
from restshape.errors import UserError
from restshape.interface.first_frame import replayed_to
from restshape.scene.load import load_scene
from restshape.scene.model import Scene

Look = Callable[[np.ndarray], float]
"""A number, linear in the displacement (n, 2) [m]."""


@dataclass(frozen=True)
class Structure:
    """A shape, and what of its motion is looked at.

    Args:
        analysis: after the frame of the shape, whose matrices are wanted.
        looks: displacements by the names of the quantities [m].
        columns: component of each, 0 or 1.
    """

    analysis: TransientAnalysis
    looks: dict[str, Look]
    columns: dict[str, int]

    @property
    def direction(self) -> np.ndarray:
        """Along which the ground moves (2,); x where it stands still."""
        excitation = self.analysis.state.integration.excitation
        return np.array([1.0, 0.0]) if excitation is None else excitation.direction

    @property
    def damped(self) -> bool:
        """Whether the scene damps the motion; if not, amplitudes at resonance are not bounded."""
        damping = self.analysis.state.integration.damping
        return damping.alpha > 0.0 or damping.beta > 0.0

    def inertia(self) -> np.ndarray:
        """M 1 (n,) [kg] at the free unknowns, along the direction of the ground."""
        body = self.analysis.body
        rigid = np.broadcast_to(self.direction, body.constrained.shape).copy()
        return np.asarray(body.mass.apply(rigid)[~body.constrained])

    def looked(self, free: np.ndarray) -> dict[str, complex]:
        """The displacements by quantity of free unknowns (n,), real or complex."""
        whole = np.zeros(self.analysis.body.constrained.shape, dtype=complex)
        whole[~self.analysis.body.constrained] = free
        real, imaginary = np.ascontiguousarray(whole.real), np.ascontiguousarray(whole.imag)
        return {name: complex(look(real), look(imaginary)) for name, look in self.looks.items()}

    def transmissibility(
        self, relative: dict[str, np.ndarray], frequencies: np.ndarray, acceleration: float
    ) -> dict[str, np.ndarray]:
        """The amplitudes (m,) in space over that of the ground, by quantity, of complex ones relative to it.

        Args:
            relative: amplitudes (m,) [m] by quantity.
            frequencies: (m,) positive [Hz]; acceleration: amplitude of the ground [m/s^2].
        """
        ground = -acceleration / (2.0 * np.pi * frequencies) ** 2
        return {
            name: np.abs(values + ground * self.direction[self.columns[name]]) / np.abs(ground)
            for name, values in relative.items()
        }


def add_structure(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments that name a scene, a frame of its edits, and outputs."""
    add_scene(parser)
    add_edits(parser, "edit script (.jsonl); the shape is that of its last frame")
    parser.add_argument("--frame", type=int, metavar="N", help="the shape is that of this frame")


def structure(args: argparse.Namespace) -> Structure:
    """The shape that the arguments name.

    Raises:
        UserError: the scene is no linear solid that vibrates, has no displacement to look at, or no such frame.
    """
    scene = load_scene(args.scene, args.set)
    if scene.app != "vibration":
        raise UserError(f"the scene is one of {scene.app!r}", str(args.scene), 'use a scene with app = "vibration"')
    if "large_deformation" in scene.effects:
        do = "leave out [effects.large_deformation]"
        raise UserError("modes and harmonic responses are those of linear solids", str(args.scene), do)
    return structure_of(replayed_to(scene, args.edits, args.frame).analysis, scene)


def structure_of(analysis: TransientAnalysis, scene: Scene) -> Structure:
    """The shape that an analysis holds, with the displacements among the quantities of a scene.

    Raises:
        UserError: there is none along x or y.
    """
    wanted = {name: one for name, one in scene.quantities.items() if one.displacement in ("x", "y")}
    if not wanted:
        do = 'add a quantity such as drift = { displacement = "x", at = "top" }'
        raise UserError("the scene has no displacement along x or y to look at", f"{scene.path}: quantities", do)
    # A mean is linear; at a vertex it is the displacement itself.
    means = {name: one.model_copy(update={"reduce": "mean"}) for name, one in wanted.items()}
    functions = analysis.problem.observer(means).functions
    return Structure(analysis, dict(functions), {name: "xy".index(one.displacement) for name, one in wanted.items()})
