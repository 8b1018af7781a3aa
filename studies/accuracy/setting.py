"""Settings of a study: which sizes, orders, policies, tolerances and study parameters are tried together."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.scale import StudyScale
from restshape_studies.verification import StudyParameter, verification

from restshape.application import Application
from restshape.errors import UserError
from restshape.policy import POLICIES
from restshape.scene.load import load_scene
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.scene.source import split_key
from restshape.shape.build import outline_from_spec

SIZES = (2.0, sqrt(2.0), 1.0, sqrt(0.5), 0.5)
TOLERANCES = (1e2, 1e-2)
"""Factors of the scene's tolerance."""
LOOSEST = 0.1
"""Largest tolerance that is tried."""


@dataclass(frozen=True)
class Setting:
    """One point of a study.

    Args:
        factor: of the scene's mesh size; order: of the elements; policy: of reuse; tolerance: of the solver.
        varied: the key that is varied alone; empty for points of the grid.
        given: value of that key, for people.
        overrides: ``key=value`` as after --set, of all that differs from the scene, the policy but for.
    """

    factor: float
    order: int
    policy: str
    tolerance: float
    varied: str = ""
    given: Any = None
    overrides: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """For people."""
        words = f"size x {self.factor:.3g}, order {self.order}, {self.policy}, tolerance {self.tolerance:g}"
        known = ("", "solve.tolerance")
        return words if self.varied in known else f"{words}, {self.varied} = {shown(self.given)}"


@dataclass(frozen=True)
class Choice:
    """What a user wants tried; None for what the study chooses by itself.

    Args:
        sizes: factors of the scene's mesh size.
        orders, policies: of the grid; tolerances: one at a time.
    """

    sizes: tuple[float, ...] | None = None
    orders: tuple[int, ...] | None = None
    tolerances: tuple[float, ...] | None = None
    policies: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Omission:
    """What was left out before it ran.

    Args:
        name: of the setting; why: for people.
    """

    name: str
    why: str


def shown(value: Any) -> str:
    """A value of a key for people."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def settings(
    path: Path, given: Sequence[str], application: Application, choice: Choice
) -> tuple[list[Setting], list[Omission]]:
    """The settings of a study, coarse ones first, and what was left out.

    Args:
        path: scene file.
        given: ``key=value`` as after --set, that hold in all of them.
        application: of the scene.
        choice: what is tried.

    Raises:
        UserError: the scene cannot be read, or is of no use for a study.
    """
    scene = load_scene(path, given)
    if scene.mesh.file:
        raise UserError(
            "a mesh from a file cannot be made finer, so that there is no reference to count errors from",
            f"{path}: mesh.file",
            "give the scene a [shape] and a mesh size",
        )
    tolerance, omitted = scene.solve.tolerance, []
    orders = choice.orders or tuple(sorted(application.orders))
    policies = choice.policies or tuple(POLICIES)
    found = []
    for order in orders:
        for factor in choice.sizes or default_sizes(scene, application, order):
            words = f"elements of order {order}"
            overrides = (*scaled(scene, factor), f"mesh.order={order}")
            why = refusal(path, (*given, *overrides))
            if why:
                omitted.append(Omission(words, why))
                break
            found += [Setting(factor, order, name, tolerance, "", None, overrides) for name in policies]
    own = scene.mesh.order or orders[0]
    policy = scene.solve.policy if scene.solve.policy in policies else policies[0]
    base = Setting(1.0, own, policy, tolerance)
    for varied in _variations(scene, application, choice, base):
        accepted, why = _accepted(path, given, scene, application, varied)
        if accepted:
            found.append(accepted)
        if why:
            omitted.append(Omission(f"{varied.varied} = {shown(varied.given)}", why))
    return found, list(dict.fromkeys(omitted))


def scaled(scene: Scene, factor: float) -> tuple[str, ...]:
    """``key=value`` of the mesh sizes times a factor; none for the scene's own."""
    if factor == 1.0:
        return ()
    near = tuple(f'mesh.near."{name}"={factor * size!r}' for name, size in scene.mesh.near.items())
    return (f"mesh.size={factor * scene.mesh.size!r}", *near)


def default_sizes(scene: Scene, application: Application, order: int) -> tuple[float, ...]:
    """The factors of the mesh size that are tried unasked: finer ones as far as they are quickly computed."""
    most = scale_of(scene, application, order).finest
    fine = [factor for factor in SIZES if unknowns(scene, application, factor, order) <= most]
    return tuple(fine) or SIZES[:1]


def scale_of(scene: Scene, application: Application, order: int | None = None) -> StudyScale:
    """How large studies of a scene may be, with elements of an order; by default of the usual one."""
    return verification(application.name).study_scale(scene, application, order or application.orders[0])


def unknowns(scene: Scene, application: Application, factor: float, order: int) -> float:
    """About how many unknowns the first shape has at a factor of the scene's mesh size."""
    outline = outline_from_spec(scene.shape, scene.folder)
    triangles = outline.area() / (0.433 * (factor * scene.mesh.size) ** 2)
    return scale_of(scene, application, order).per_node * triangles * (0.5 if order == 1 else 2.0)


def refusal(path: Path, overrides: Sequence[str]) -> str:
    """Why a scene cannot be had with overrides; empty where it can."""
    try:
        load_scene(path, overrides)
    except UserError as error:
        return error.what
    return ""


# --- one at a time ----------------------------------------------------------------------------------------------------


def _variations(scene: Scene, application: Application, choice: Choice, base: Setting) -> Iterator[Setting]:
    """Settings that differ from the scene's own in one key, or in one and the mesh size."""
    own = base.tolerance
    wanted = choice.tolerances or tuple(factor * own for factor in TOLERANCES if factor * own <= LOOSEST)
    for value in wanted:
        if value != own:
            overrides = (f"solve.tolerance={value!r}",)
            yield replace(base, tolerance=value, varied="solve.tolerance", given=value, overrides=overrides)
    for parameter in study_parameters(scene, application):
        sizes = choice.sizes or default_sizes(scene, application, base.order) if parameter.grid else (1.0,)
        for value, overrides in _turned(scene, application, parameter):
            for factor in sizes:
                changed = (*scaled(scene, factor), *overrides)
                yield replace(base, factor=factor, varied=parameter.key, given=value, overrides=changed)


def study_parameters(scene: Scene, application: Application) -> list[StudyParameter]:
    """The application's parameters that mean something in a scene."""
    planned, found = plan(scene, application), []
    for parameter in verification(application.name).parameters:
        if parameter.effect and not planned.on(parameter.effect):
            continue
        # Such as the time step of what is steady, which has none.
        if parameter.factors and present(scene, application, parameter.key) is None:
            continue
        if not parameter.values or present(scene, application, parameter.key) in (None, *parameter.values):
            found.append(parameter)
    return found


def _turned(scene: Scene, application: Application, parameter: StudyParameter) -> Iterator[tuple[Any, tuple[str, ...]]]:
    """Each value that a parameter is set to, with its ``key=value``."""
    own = present(scene, application, parameter.key)
    for value in parameter.values:
        if value != own:
            yield value, (f"{parameter.key}={value}",)
    for factor in parameter.factors:
        changed = times(scene, application, parameter, factor)
        if changed:
            yield factor * own, changed


def times(scene: Scene, application: Application, parameter: StudyParameter, factor: float) -> tuple[str, ...]:
    """``key=value`` of a parameter times a factor; none where what goes against it would not be a whole number."""
    changed = (f"{parameter.key}={factor * present(scene, application, parameter.key)!r}",)
    if not parameter.against:
        return changed
    other = present(scene, application, parameter.against) / factor
    whole = round(other)
    return (*changed, f"{parameter.against}={whole}") if whole >= 1 and abs(whole - other) < 1e-9 else ()


def present(scene: Scene, application: Application, key: str) -> Any:
    """The value that a key of a scene has, its default where the scene leaves it out."""
    first, *rest = split_key(key)
    if first == "effects":
        return getattr(plan(scene, application).settings(rest[0]), rest[1])
    here: Any = scene
    for part in (first, *rest):
        here = here[part] if isinstance(here, dict) else getattr(here, part)
    return here


def _accepted(
    path: Path, given: Sequence[str], scene: Scene, application: Application, setting: Setting
) -> tuple[Setting | None, str]:
    """The setting, of another order where its own cannot be had, and what had to be left out."""
    first = ""
    for order in (setting.order, *(order for order in application.orders if order != setting.order)):
        changed = setting.overrides if order == scene.mesh.order else (*setting.overrides, f"mesh.order={order}")
        why = refusal(path, (*given, *changed))
        if not why:
            note = f"order {setting.order}: {first}; run with order {order}" if first else ""
            return replace(setting, order=order, overrides=changed), note
        first = first or why
    return None, first
