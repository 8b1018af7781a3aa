"""Scenes with parts of their physics left out."""

from collections.abc import Iterable

from restshape.application import Application
from restshape.errors import UserError
from restshape.scene.load import remade
from restshape.scene.model import Scene
from restshape.scene.plan import plan


def without(scene: Scene, application: Application, names: Iterable[str]) -> Scene:
    """The scene without these effects, and without the quantities that there are with them only.

    Args:
        scene: is left as it is.
        application: of the scene.
        names: of effects, named or derived ones; those that are off already change nothing.

    Raises:
        UserError: the application cannot do without one of them, or what is left makes no scene.
    """
    on = frozenset(effect.name for effect in plan(scene, application).effects if effect.on)
    raw = scene.raw
    for name in names:
        effect, derived = application.effects.get(name), application.derived.get(name)
        if effect is None and derived is None:
            raise UserError(f"{application.name!r} has no effect {name!r}", str(scene.path), "name one that it has")
        if derived is not None:
            if derived.without is None:
                raise UserError(f"{name!r} cannot be left out", str(scene.path), "leave it on")
            raw = derived.without(raw, on)
            continue
        if effect.required:
            raise UserError(f"{application.name!r} always has {name!r}", str(scene.path), "leave it on")
        effects = {key: value for key, value in raw.get("effects", {}).items() if key != name}
        raw = {**raw, "effects": effects}
        if effect.without:
            raw = effect.without(raw, on)
        if quantities := raw.get("quantities"):
            own = set(effect.quantities)
            kept = {key: one for key, one in quantities.items() if not (isinstance(one, dict) and own & set(one))}
            raw["quantities"] = kept
    return scene if raw is scene.raw else remade(scene, raw)
