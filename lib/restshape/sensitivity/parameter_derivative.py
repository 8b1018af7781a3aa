"""How frequencies follow the numbers of a scene: materials, thickness, and parameters, also those of its shape."""

import numpy as np

from restshape.errors import ReplayProblem, UserError
from restshape.fem.assembled import Assembled
from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.problem import MASS, STIFFNESS
from restshape.scene.given_numbers import value_below
from restshape.scene.load import revise
from restshape.sensitivity.frequency_derivative import SolvedModes, design_products, known_modes, rates
from restshape.sensitivity.outline_velocity import outline_velocity

STEP = 1e-4
"""Of the differences of K and M at fixed modes, a share of the value, or for 0 this [SI]: the first that is tried."""

LONGER = 1.7
"""Each step is checked by one that is longer by this; no whole number, so that both are not rounded alike."""

AGREED = 1e-6
"""Difference of both, as a share of the largest derivative, with which a step is taken."""

FACTORS = (1.0, 1e3, 1e-3, 1e6, 1e-6, 1e9, 1e12)
"""Steps that are tried one after the other: near 0 a value does not show the scale of its number."""

KEYS = ("material", "parameters")
"""Tables whose numbers have derivatives."""


def parameter_derivatives(analysis: SolvedModes, key: str) -> np.ndarray:
    """Derivatives (modes,) [Hz a SI unit of the number] of the frequencies that the scene asks for.

    K and M are differenced at fixed modes, which no solve enters: phi (K' - lambda M') phi, and for eigenvalues that
    coincide the subspace rule. The step is the first, of `FACTORS`, that a longer one confirms within `AGREED` of the
    largest derivative; where none does, the one that the longer one comes nearest to, which for a number that hardly
    does anything leaves rounding. Where a parameter gives the shape, nodes follow the outline, and what K and M change
    by their motion is added.

    Args:
        analysis: solved on the mesh as it lies.
        key: dotted, such as "material.brass.E", "material.wood.orthotropic.G.0" or "parameters.depth".

    Raises:
        UserError: no such number, or one that changes how edges of the shape bend.
        UserError, ReplayProblem: the scene makes no sense a step aside, however short.

    Source: docs/theory/free-vibrations.md.
    """
    value = number_at(analysis, key)
    best, error, refusal = None, np.inf, None
    for factor in FACTORS:
        step = factor * STEP * (abs(value) or 1.0)
        try:
            found, longer = (_differenced(analysis, key, value, h) for h in (step, LONGER * step))
        except (ReplayProblem, UserError) as refused:
            refusal = refusal or refused
            continue
        size = float(np.abs(found).max())
        apart = float(np.abs(found - longer).max())
        # A step that is lost in rounding gives 0, so that 0 is believed where no step gives anything else.
        apart = apart / size if size > 0.0 else np.inf
        if best is None or apart < error:
            best, error = found, apart
        if error <= AGREED:
            break
    if best is None:
        raise refusal
    return best


def _differenced(analysis: SolvedModes, key: str, value: float, step: float) -> np.ndarray:
    """The derivatives (modes,) by central differences with a step.

    Raises:
        UserError, ReplayProblem: the scene makes no sense there.
    """
    state, known, ends = analysis.state, known_modes(analysis), []
    scenes = [revise(state.scene, *_revision(analysis, key, changed)) for changed in (value + step, value - step)]
    for scene in scenes:
        body = analysis.make(scene, state.plan, state.space, analysis.context.policy.lumped_mass)
        ends.append([_products(body, state.modes.vectors[known], kind) for kind in (STIFFNESS, MASS)])
    stiff, mass_products = ((ahead - behind) / (2.0 * step) for ahead, behind in zip(*ends))
    if not (np.isfinite(stiff).all() and np.isfinite(mass_products).all()):
        raise UserError(f"{value:g} +- {step:g} makes no sense", key, "choose another value")
    velocity = outline_velocity(state.space, state.scene, scenes, step)
    if velocity is not None:
        moved = np.stack([velocity, np.zeros_like(velocity)])
        by_motion = design_products(analysis, state.modes.vectors[known], state.body.motion(moved)[0])
        stiff, mass_products = stiff + by_motion[0], mass_products + by_motion[1]
    return rates(analysis, known, stiff, mass_products)


def number_at(analysis: SolvedModes, key: str) -> float:
    """The number [SI] that a key names.

    Raises:
        UserError: it names none, or one of another table.
    """
    parts = key.split(".")
    if parts[0] not in KEYS:
        raise UserError(
            f"{key!r} is neither of a material nor a parameter",
            "--by",
            "name one like material.brass.E; for the outline ask for --outline",
        )
    here = value_below(analysis.state.scene, tuple(parts))
    if isinstance(here, bool) or not isinstance(here, int | float):
        raise UserError(f"{key!r} is no number of this scene", "--by", "name one like material.brass.E")
    return float(here)


def _revision(analysis: SolvedModes, key: str, value: float) -> tuple[str, object]:
    """The key to change and its new value: of a list the whole of it."""
    whole, _, place = key.rpartition(".")
    around = value_below(analysis.state.scene, tuple(whole.split(".")))
    if not isinstance(around, list | tuple):
        return key, value
    return whole, [value if k == int(place) else known for k, known in enumerate(around)]


def _products(problem: Eigenproblem, modes: np.ndarray, kind: str) -> np.ndarray:
    """K phi or M phi (k, n f) of modes (k, n f), of the integrals of a kind."""
    assembled, boundary, found = Assembled(problem.integrals(kind)), problem.boundary, np.empty_like(modes)
    for mode, row in zip(modes, found):
        product = assembled.residual(np.ascontiguousarray(mode.reshape(boundary.mask.shape)))
        boundary.zero(product)
        row[:] = product.ravel()
    return found
