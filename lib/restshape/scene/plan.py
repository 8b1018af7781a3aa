"""Which effects a scene calls for, and why: nothing else is simulated."""

from dataclasses import dataclass

from pydantic import BaseModel

from restshape.application import Application
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
    """All effects of an application, as one scene calls for them."""

    effects: tuple[PlannedEffect, ...]

    def on(self, name: str) -> bool:
        """Whether the effect is simulated."""
        return any(effect.on for effect in self.effects if effect.name == name)

    def settings(self, name: str) -> BaseModel | None:
        """The effect's keys with defaults filled in; None when it is off or unknown."""
        return next((effect.settings for effect in self.effects if effect.name == name), None)


def plan(scene: Scene, application: Application) -> Plan:
    """The effects that a scene calls for: those that it names, and those that the application always needs."""
    planned = []
    for name, effect in application.effects.items():
        if name in scene.effects:
            settings = effect.model.model_validate(scene.effects[name])
            planned.append(PlannedEffect(name, True, f"the scene names it in [effects.{name}]", settings))
        elif effect.required:
            planned.append(PlannedEffect(name, True, f"{application.name} always has it", effect.model()))
        else:
            planned.append(PlannedEffect(name, False, f"the scene has no [effects.{name}]"))
    return Plan(tuple(planned))
