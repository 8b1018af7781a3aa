"""Which effects a scene calls for, and why: nothing else is simulated."""

from dataclasses import dataclass

from pydantic import BaseModel

from restshape.application import Application, Deciding, Decision
from restshape.errors import UserError
from restshape.scene.model import Scene


@dataclass(frozen=True)
class PlannedEffect:
    """One effect of the application, on or off.

    Args:
        name: as the application names it.
        on: whether it is simulated.
        why: the reason, for people.
        settings: its keys with defaults filled in; None when off.
    """

    name: str
    on: bool
    why: str
    settings: BaseModel | None = None


@dataclass(frozen=True)
class Plan:
    """All effects of an application, as one scene calls for them.

    Args:
        effects: in the application's order.
        order: of the elements.
        warnings: what makes answers bad, for people.
    """

    effects: tuple[PlannedEffect, ...]
    order: int = 1
    warnings: tuple[str, ...] = ()

    def on(self, name: str) -> bool:
        """Whether the effect is simulated."""
        return any(effect.on for effect in self.effects if effect.name == name)

    def settings(self, name: str) -> BaseModel | None:
        """The effect's keys with defaults filled in; None when it is off or unknown."""
        return next((effect.settings for effect in self.effects if effect.name == name), None)


def plan(scene: Scene, application: Application) -> Plan:
    """The effects that a scene calls for: those that it names, and those that the application always needs.

    Raises:
        UserError: an effect cannot be had in this scene.
    """
    planned, orders, warnings = [], [scene.mesh.order], []
    for name, effect in application.effects.items():
        if name not in scene.effects and not effect.required:
            planned.append(PlannedEffect(name, False, f"the scene has no [effects.{name}]"))
            continue
        named = name in scene.effects
        why = f"the scene names it in [effects.{name}]" if named else f"{application.name} always has it"
        decision = _decision(effect.model.model_validate(scene.effects[name] if named else {}), scene)
        planned.append(PlannedEffect(name, True, f"{why}; {decision.why}" if decision.why else why, decision.settings))
        orders.append(decision.order)
        warnings += [f"effects.{name}: {decision.why}"] if decision.warns else []
    wanted = [order for order in orders if order in application.orders]
    return Plan(tuple(planned), wanted[0] if wanted else application.orders[0], tuple(warnings))


def refuse_switched(old: Scene, new: Scene, application: Application) -> None:
    """Refuses an edit from one scene to another that switches an effect with which the analysis is another one.

    Raises:
        UserError: such an effect is on in one of them only.
    """
    for name, effect in application.effects.items():
        if effect.fixed and not effect.required and (name in old.effects) != (name in new.effects):
            way = "off" if name in old.effects else "on"
            do = f"make it two scenes, one with [effects.{name}] and one without"
            raise UserError(f"the effect {name!r} cannot be switched {way} during an edit", do=do)


def _decision(settings: BaseModel, scene: Scene) -> Decision:
    """What an effect settles for the scene; its keys as they are if it has nothing to decide."""
    return settings.decide(scene) if isinstance(settings, Deciding) else Decision(settings)
