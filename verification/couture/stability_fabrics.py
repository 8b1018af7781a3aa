"""Hard fabrics of cloth: limp, light, thick beside thin, held by one point or along one edge."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, above, below, near, true, valid
from restshape_studies.stability.known_bounds import BALANCE, STATIONARY
from restshape_studies.stability.scenery import block, meshed
from restshape_verification.couture.hard_scenes import (
    CONTACT,
    GRAVITY,
    HEAD,
    QUANTITIES,
    ball,
    cloth,
    cotton,
    pinned,
    played,
    resting,
    square,
    start,
)

from restshape.errors import UserError

PINS = pinned("c", "d")
CLAMP = pinned("left", fix='["x", "y", "z", "slope"]')
PATCH = "\n[shape.regions]\npatch = { polygon = [[0.1, 0.1], [0.2, 0.1], [0.2, 0.2], [0.1, 0.2]] }\n"
FABRIC = """
[material.{name}]
E = "1 MPa"
nu = 0.3
rho = {rho}
thickness = {thickness}
{more}
"""
FOLDS = 0.02
"""Difference of the energies of two meshes of one size, over their size: they fold elsewhere."""
WEIGHT = 0.3**2 * 500 * 0.3e-3 * 9.81
"""Of the square of cotton [N]."""


def patched(first: str, inner: str, *parts: str, kind: str = "hinge") -> str:
    """The square of one fabric with a patch of another one."""
    head = HEAD + block(0.3, 0.3) + PATCH + first + inner + cloth(kind) + GRAVITY + meshed(0.025) + QUANTITIES
    return head + "".join(parts)


def fabric(name: str, thickness: float, rho: float = 500.0, more: str = "") -> str:
    """A material of a thickness [m]."""
    return FABRIC.format(name=name, thickness=thickness, rho=rho, more=more)


def limp(trial: Trial) -> Iterator[Statement]:
    """Cloth on two pins whose bending stiffness is 1e-12 N m, and none at all: at rest with the same energy."""
    without, rows = played(trial, square(0.025, PINS, kind="none"))
    yield from resting(without, rows)
    wanted = rows[0]["q_potential"]
    for kind in ("morley", "hinge", "nonlinear"):
        for stiffness in (1e-12, 0.0):
            made, rows = played(trial, square(0.025, PINS, kind=kind, bending=stiffness))
            yield from resting(made, rows)
            yield near(
                f"energy is that without bending ({kind}, {stiffness:g})", rows[0]["q_potential"], wanted, STATIONARY
            )
            # Half of the stiffness times the square of the curvature, over the area.
            yield below("energy of bending [J]", rows[0]["q_bent"], 10.0 * stiffness)


def limp_in_part(trial: Trial) -> Iterator[Statement]:
    """Morley's triangles where a part alone has no bending stiffness: refused in words; with a little it rests."""
    plain = fabric("whole", 0.3e-3)
    for value, clamped in (("0", False), ("1e-12", True)):
        inner = fabric("inner", 0.3e-3, more=f'region = "patch"\nbending = {value}')
        try:
            made, rows = played(trial, patched(plain, inner, PINS, kind="morley"))
        except UserError as error:
            yield true("refused for its slopes", not clamped and "does not resist bending" in str(error), str(error))
            continue
        yield true("refused only without any stiffness", clamped)
        yield from resting(made, rows)


def one_pin(trial: Trial) -> Iterator[Statement]:
    """Cloth held at one corner, which it may turn about: it hangs below the pin, which bears its weight."""
    force = 'pin = { reaction = "z", at = "c" }\n'
    for kind in ("morley", "hinge"):
        text = square(0.025, kind=kind) + force + pinned("c")
        for more, bound in (("", 0.02), (start(0.3), 0.1)):
            made, rows = played(trial, text + more)
            yield from resting(made, rows)
            yield near("force of the pin is the weight", rows[0]["q_pin"], WEIGHT, 1e-7)
            sheet = made.analysis.problem
            middle = sheet.lumped.mass @ made.analysis.x / sheet.lumped.mass.sum()
            yield below("middle beside the pin [m]", float(np.abs(middle[:2] - 0.3).max()), 1e-5)
            # A diagonal that hangs straight has 0.3 sqrt(2); folds from a start at random take some of it.
            yield near("lowest place below the pin", rows[0]["q_lowest"], -0.3 * 2**0.5, bound)


def contrast(trial: Trial) -> Iterator[Statement]:
    """A patch 100 times as thick as the cloth around it, and as thin: bending stiffnesses as 1 to a million."""
    thin, thick = 0.05e-3, 5e-3
    for outer, inner in ((thin, thick), (thick, thin)):
        fabrics = fabric("outer", outer), fabric("inner", inner, more='region = "patch"')
        for kind in ("morley", "hinge"):
            made, rows = played(trial, patched(*fabrics, PINS, kind=kind))
            yield from resting(made, rows)
        made, rows = played(trial, patched(*fabrics, PINS, start(0.1), kind="hinge"))
        yield from resting(made, rows)


def unequal_weights(trial: Trial) -> Iterator[Statement]:
    """A region that weighs nothing: refused in words under gravity; a millionth of the weight is none, and rests."""
    plain = fabric("whole", 0.3e-3)

    def text(rho: float) -> str:
        return patched(plain, fabric("inner", 0.3e-3, rho, 'region = "patch"'), PINS)

    try:
        trial.rows(text(0.0))
        yield true("refused", False)
    except UserError as error:
        yield true("refused for its density", "has no density" in str(error), str(error))
    made, rows = played(trial, text(5e-4))
    yield from resting(made, rows)
    # Without gravity there is nothing against it.
    made, rows = played(trial, (text(0.0) + start(0.01)).replace(GRAVITY, ""))
    yield from valid(rows)
    yield true("in equilibrium without gravity", rows[0]["converged"] == 1, rows[0]["note"])


def cantilever(parameter: float, stiffness: float, kind: str) -> str:
    """A clamped strip of 0.2 m, by weight times length^3 over bending stiffness, and by membrane stiffness [Pa]."""
    bending = 500 * 0.3e-3 * 9.81 * 0.2**3 / parameter
    fabric = cotton(bending).replace('"1 MPa"', repr(stiffness)).replace("nu = 0.3", "nu = 0")
    text = HEAD + block(0.2, 0.05) + fabric + cloth(kind) + GRAVITY + meshed(0.0125) + QUANTITIES
    return text + 'wall = { reaction = "z", at = "left" }\n' + CLAMP


def thinnest(trial: Trial) -> Iterator[Statement]:
    """A horizontal cantilever of ever thinner fabric, up to a hundred millionth of what holds itself up: it hangs."""
    fallen = 0.0
    for parameter in (8.0, 1e3, 1e5, 1e8):
        made, rows = played(trial, cantilever(parameter, 1e6, "morley"))
        yield from resting(made, rows)
        weight = 0.2 * 0.05 * 500 * 0.3e-3 * 9.81
        yield near(f"force at the clamp is the weight ({parameter:g})", rows[0]["q_wall"], weight, BALANCE)
        yield above("it hangs lower than a stiffer one", -rows[0]["q_lowest"], fallen)
        yield below("it hangs no longer than it is [m]", -rows[0]["q_lowest"], 0.2 * 1.001)
        fallen = -rows[0]["q_lowest"]
    for stiffness, kind in ((1e8, "morley"), (1e8, "hinge"), (1e8, "none")):
        made, rows = played(trial, cantilever(1e8, stiffness, kind))
        # A stiff membrane makes differences of energies less exact.
        yield from resting(made, rows, way=1e-8)


def limp_on_nested_meshes(trial: Trial) -> Iterator[Statement]:
    """A membrane of 3 N/m on a ball, which coarse meshes hardly see: it rests as on one mesh."""
    limp = 'material.cotton.E="10 kPa"'
    text = square(0.0209, ball(0.35, 0.35, 0.2), CONTACT, side=0.7)
    alone, rows = played(trial, text, overrides=[limp])
    yield from resting(alone, rows)
    wanted = rows[0]["q_potential"]
    nested, rows = played(trial, text, overrides=[limp, "mesh.levels=3", "effects.drape.levels=3"])
    yield from resting(nested, rows)
    yield true("stable", rows[0]["tangent_positive_definite"] == 1)
    yield near("energy is that on one mesh [J]", rows[0]["q_potential"], wanted, FOLDS)


CASES = {
    "limp": Case(limp),
    "limp_in_part": Case(limp_in_part),
    "limp_on_nested_meshes": Case(
        limp_on_nested_meshes, exempt={"thesis": "motion alone starts on the finest mesh"}, weekly=("auto",)
    ),
    "one_pin": Case(one_pin, exempt={"thesis": "motion alone comes to rest in other folds"}),
    "contrast": Case(contrast, weekly=("auto",)),
    "unequal_weights": Case(unequal_weights),
    "thinnest": Case(thinnest),
}
