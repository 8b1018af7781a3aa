"""What makes cloth cycle for ever on its way to rest, and what cures it.

The author's released program moves cloth in steps of one length with kinetic damping. The force of its contact begins
with a kink; normal forces, and anchors of friction on springs about as stiff as contact, are taken in each step.
Here cloth on a ball is moved like that until it goes round. From there it goes on once more like that, with either
cause taken away, with both, with both and an eye on the energy, and by the way of this application.
"""

# More than 15 modules: the motion is set up by hand from the parts that cloth is relaxed by.

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np
from petsc4py import PETSc

from restshape.algebra.linear import LinearSolver
from restshape.algebra.nonlinear.kinetic_damping import KineticDamping, Steps
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.application import application, application_of
from restshape.calibration import Calibration
from restshape.cli.options import add_json, write_json
from restshape.errors import ReplayProblem, one_line
from restshape.mesh.generate import generate
from restshape.outputs.kinds import PictureFile
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.equilibrium import SLIPPING, EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.scene import ClothArguments, cloth_arguments, cloth_problem
from restshape.scene.load import load_scene
from restshape.scene.plan import plan
from restshape.shape.build import outline_from_spec

SCENE = application("couture").folder / "scenes" / "sphere.toml"
HINGES = "effects.cloth.bending=hinge"
TIME_STEP = 1.0 / 60.0
KINK = 1e-9
"""Distance [m] in which the stiffness of contact rises from zero: as good as at once."""
SLIP = 1e-5
"""Way [m] at which friction is all there: springs about as stiff as contact under the cloth's weight."""
BEFORE, AFTER = 300, 400
"""Steps until the cloth goes round, and steps of each way on from there."""
LATE = 100
"""Steps at the end of which the speed is reported."""
REST = 1e-4


@dataclass
class Course:
    """How a cloth fares, step by step.

    Args:
        residuals: norm of the residual over the weight.
        speeds: of the fastest node [m/s]; None where it has not moved yet; empty where steps have no one length.
        converged: it is in equilibrium, friction included.
    """

    residuals: list[float] = field(default_factory=list)
    speeds: list[float | None] = field(default_factory=list)
    converged: bool = False


@dataclass(frozen=True)
class Manner:
    """How contact is dealt with.

    Args:
        kink: the force begins with one; otherwise it is smooth.
        refreshed: normal forces and anchors are taken in each step, else they stay until the cloth rests with them.
        checked: steps that gain energy are taken back; otherwise all have one length and stand.
    """

    kink: bool
    refreshed: bool
    checked: bool = False


AUTHOR = Manner(True, True)
MANNERS = {
    "as the author's program": AUTHOR,
    "friction kept, kink": Manner(True, False),
    "smooth onset, friction in each step": Manner(False, True),
    "smooth onset, friction kept": Manner(False, False),
    "smooth onset, friction kept, steps that gain energy taken back": Manner(False, False, True),
}
OURS = "smooth onset, friction kept, descent"


class Cloth:
    """The scene's cloth, to be made again and again as it was at some time.

    Args:
        overrides: ``key=value`` as after --set, of the scene of cloth on a ball.
    """

    def __init__(self, overrides: Sequence[str] = ()) -> None:
        self.scene = load_scene(SCENE, (HINGES, *overrides))
        chosen = plan(self.scene, application_of(self.scene))
        self.mesh = generate(outline_from_spec(self.scene.shape, self.scene.folder), self.scene.mesh)
        self.arguments: ClothArguments = cloth_arguments(self.scene, chosen, self.mesh)

    def sheet(self, kink: bool, like: ClothProblem | None = None) -> ClothProblem:
        """A sheet with one onset of contact or the other, with the history of friction that another one has."""
        sheet = cloth_problem(self.mesh, self.arguments)
        sheet.contact.slip = SLIP
        # The author's program touches with nodes alone, and bodies alone.
        sheet.self_contact = None
        sheet.contact.history = replace(sheet.contact.history, points=None)
        if kink:
            sheet.contact.thickness = KINK
            # Below this thin onset the spring is that of the surface.
            sheet.contact.stiffness *= float(np.exp(-8.0))
        if like:
            sheet.contact.history = like.contact.history
        return sheet


def move(sheet: ClothProblem, x: np.ndarray, manner: Manner, most: int) -> Course:
    """The course of a cloth in implicit steps with kinetic damping from x (n, 3), which is changed.

    Args:
        sheet: the cloth, with the onset of that manner.
        x: positions [m].
        manner: of contact and steps.
        most: steps.
    """
    course, before = Course(), x.copy()
    equations = ClothEquations(sheet, PETSc.COMM_SELF, Stages())

    def note(x: np.ndarray, norm: float) -> bool:
        course.residuals.append(norm / sheet.lumped.load)
        if not manner.checked:
            course.speeds.append(float(np.linalg.norm(x - before, axis=1).max()) / TIME_STEP or None)
            before[:] = x
        return False

    while len(course.residuals) <= most:
        longest = Steps().longest if manner.checked else TIME_STEP
        left = Steps(TIME_STEP, longest=longest, most=most - len(course.residuals))
        moving = KineticDamping(PETSc.COMM_SELF, "cycles_", equations, sheet.lumped.mass, x.shape, equations.rows, left)
        moving.on_step = note
        if manner.refreshed:
            moving.on_move = sheet.follow_friction
        try:
            norm = moving.run(x, REST * sheet.lumped.load)
        except ReplayProblem:
            # Steps that nothing checks may go so deep into a body that the next one has no solution.
            break
        finally:
            moving.free()
        if norm > REST * sheet.lumped.load:
            break
        note(x, norm)
        # Only now friction follows; where that leaves a residual, the cloth moves on.
        slipped, forces = sheet.update_friction(x), np.empty_like(x)
        sheet.residual(x, forces)
        course.converged = slipped <= SLIPPING * SLIP and float(np.linalg.norm(forces)) <= REST * sheet.lumped.load
        if course.converged:
            break
    return course


def converge(sheet: ClothProblem, x: np.ndarray) -> Course:
    """The course of a cloth by descent and Newton's method from x (n, 3), which is changed."""
    course, stages = Course(), Stages()
    traits = Traits(fields=3, dimension=3)
    linear = LinearSolver(PETSc.COMM_SELF, "cycles_linear_", "auto", REST, Calibration.load(), stages, traits=traits)
    rest = EquilibriumSolver(sheet, PETSc.COMM_SELF, stages, linear, REST, prefix="cycles_")
    rest.on_iterate = lambda _solver, _x, residual: course.residuals.append(residual)
    course.converged = rest.converge(x, 3 * AFTER, ConvergenceReport()).converged
    rest.destroy()
    return course


def study(overrides: Sequence[str] = (), before: int = BEFORE, after: int = AFTER) -> dict[str, Course]:
    """The courses by name: until the cloth goes round ("start"), and on from there.

    Args:
        overrides: ``key=value`` as after --set.
        before, after: steps until then, and from then.
    """
    cloth = Cloth(overrides)
    first = cloth.sheet(AUTHOR.kink)
    x = first.flat(cloth.arguments.start)
    first.update_friction(x)
    courses = {"start": move(first, x, AUTHOR, before)}
    for name, manner in MANNERS.items():
        courses[name] = move(cloth.sheet(manner.kink, first), x.copy(), manner, after)
    courses[OURS] = converge(cloth.sheet(False, first), x.copy())
    return courses


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="residuals and speeds against steps (.png)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scene")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print how each course ends, and draw them; 0."""
    courses = study(args.set)
    for name, course in courses.items():
        late = [speed for speed in course.speeds[-LATE:] if speed is not None]
        speed = f", fastest node in the last {LATE} steps {max(late):.2g} m/s" if late else ""
        end = "converged" if course.converged else "not converged"
        steps, residual = len(course.residuals), course.residuals[-1]
        print(f"{name}: {end} after {steps} steps, residual {residual:.1e} of the weight{speed}")
    write_json(args, {name: asdict(course) for name, course in courses.items()})
    if args.picture:
        from restshape_studies.pictures.cycles import draw_cycles

        draw_cycles(args.picture, courses, REST)
        print(f"wrote {one_line(args.picture)}")
    return 0
