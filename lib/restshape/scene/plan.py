"""Which effects a scene calls for, and which solvers, and why: nothing else is simulated."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from weakref import ref

from pydantic import BaseModel

from restshape.application import Application
from restshape.errors import UserError
from restshape.scene.effect import DerivedEffect, ResolvedSettings, SettingsResolver
from restshape.scene.model import Scene
from restshape.scene.physics import Physics
from restshape.scene.plain_values import table_in
from restshape.scene.solver import SolverPlan, joint


@dataclass(frozen=True)
class PlannedEffect:
    """One effect of the application, on or off.

    Args:
        name: as the application names it.
        on: whether it is simulated.
        why: the reason, for people.
        settings: its keys with defaults filled in; None when off, and of derived effects.
        cause: what calls for it: "named" in the scene, "required" by the application, or it "follows" from the scene;
            "none" when off.
    """

    name: str
    on: bool
    why: str
    settings: BaseModel | None = None
    cause: str = "none"


@dataclass(frozen=True)
class Plan:
    """All effects of an application, as one scene calls for them.

    Args:
        effects: in the application's order.
        derived: effects that follow from the scene without being named, likewise.
        solver: which equations there are, and how they are solved.
        order: of the elements.
        order_why: the reason.
        warnings: what makes answers bad, for people.
        tolerance: of the solver where the scene names none; None: the usual one.
    """

    effects: tuple[PlannedEffect, ...]
    derived: tuple[PlannedEffect, ...]
    solver: SolverPlan
    order: int = 1
    order_why: str = ""
    warnings: tuple[str, ...] = ()
    tolerance: float | None = None

    def on(self, name: str) -> bool:
        """Whether the effect is simulated."""
        return any(effect.on for effect in (*self.effects, *self.derived) if effect.name == name)

    def settings(self, name: str) -> BaseModel | None:
        """The effect's keys with defaults filled in; None when it is off or unknown."""
        return next((effect.settings for effect in self.effects if effect.name == name), None)


_LATEST: deque[tuple[ref[Scene], Application, Plan]] = deque(maxlen=4)
"""Plans of the scenes that were asked for last: those of the frame before and of this one."""


def plan(scene: Scene, application: Application) -> Plan:
    """The effects that a scene calls for: those that it names, and those that the application always needs.

    Raises:
        UserError: an effect cannot be had in this scene.
    """
    for known, of, found in _LATEST:
        if known() is scene and of is application:
            return found
    _LATEST.append((ref(scene), application, _planned(scene, application)))
    return _LATEST[-1][2]


def _planned(scene: Scene, application: Application) -> Plan:
    """The same, which is not known yet."""
    planned, warnings, tolerances = [], [], []
    orders: list[tuple[int | None, str]] = [(scene.mesh.order, "the scene says so in mesh.order")]
    for name, effect in application.effects.items():
        if name not in scene.effects and not effect.required:
            planned.append(PlannedEffect(name, False, f"the scene has no [effects.{name}]"))
            continue
        named = name in scene.effects
        why = f"the scene names it in [effects.{name}]" if named else f"{application.name} always has it"
        decision = _decision(effect.model.model_validate(scene.effects[name] if named else {}), scene)
        why = f"{why}; {decision.why}" if decision.why else why
        planned.append(PlannedEffect(name, True, why, decision.settings, "named" if named else "required"))
        orders.append((decision.order, f"{name} asks for it{decision.why and ': ' + decision.why}"))
        if decision.warns:
            warnings.append(f"effects.{name}: {decision.why if decision.warns is True else decision.warns}")
        tolerances += [decision.tolerance] if decision.tolerance is not None else []
    on = frozenset(effect.name for effect in planned if effect.on)
    derived = tuple(_derived(name, effect, scene, on) for name, effect in application.derived.items())
    settings = {effect.name: effect.settings for effect in planned}
    solver = joint([made for _, made in _solvers(scene, application, on, settings)])
    usual = (application.orders[0], application.order_why)
    possible = ((order, why) for order, why in orders if order is not None and order in application.orders)
    order, order_why = next(possible, usual)
    tolerance = min(tolerances, default=None)
    return Plan(tuple(planned), derived, solver, order, order_why, tuple(warnings), tolerance)


def solved_physics(scene: Scene, application: Application) -> list[Physics]:
    """The physics of an application that make equations of a scene."""
    settings = {effect.name: effect.settings for effect in plan(scene, application).effects}
    return [one for one, _ in _solvers(scene, application, _on(scene, application), settings)]


def _solvers(
    scene: Scene, application: Application, on: frozenset[str], settings: Mapping[str, object]
) -> list[tuple[Physics, SolverPlan]]:
    """Physics that make equations, with how these are solved."""
    found = ((one, one.solver(scene, on, settings)) for one in application.physics)
    return [(one, made) for one, made in found if made]


def as_written(scene: Scene) -> Scene:
    """The scene with the element order that its user has written, None where they left it to the plan."""
    order = table_in(scene.raw, "mesh").get("order")
    return scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"order": order})})


def _derived(name: str, effect: DerivedEffect, scene: Scene, on: frozenset[str]) -> PlannedEffect:
    """Whether a scene calls for what it does not name."""
    why = effect.cause(scene, on)
    return PlannedEffect(name, bool(why), why or effect.idle, None, "follows" if why else "none")


def refuse_switched(old: Scene, new: Scene, application: Application) -> None:
    """Refuses an edit from one scene to another that switches an effect with which the analysis is another one.

    Raises:
        UserError: such an effect is on in one of them only, or something differs that the physics say is invariant, or
            to matter at the start alone.
    """
    for name, effect in application.effects.items():
        if effect.fixed and not effect.required and (name in old.effects) != (name in new.effects):
            way = "off" if name in old.effects else "on"
            do = f"make it two scenes, one with [effects.{name}] and one without"
            raise UserError(f"the effect {name!r} cannot be switched {way} during an edit", do=do)
        for key in effect.start_keys:
            was, now = (scene.effects.get(name, {}) for scene in (old, new))
            if was and now and was[key] != now[key]:
                what = f"effects.{name}.{key} matters at the start alone, and the edit comes later"
                raise UserError(what, do="change it in the scene, or use --set")
    for invariant in (one for physics in application.physics for one in physics.invariants):
        before, after = (invariant.of(one, _on(one, application)) for one in (old, new))
        if before != after:
            raise UserError(invariant.what, do=invariant.do)


def _on(scene: Scene, application: Application) -> frozenset[str]:
    """Names of the effects that are on."""
    return frozenset(name for name, effect in application.effects.items() if effect.required or name in scene.effects)


def _decision(settings: BaseModel, scene: Scene) -> ResolvedSettings:
    """What an effect's settings resolve to for the scene; its keys as they are if it has nothing to decide."""
    return settings.resolve(scene) if isinstance(settings, SettingsResolver) else ResolvedSettings(settings)
