"""The effects of a scene: each validated by the keys that its application gives it."""

from pydantic import ValidationError

from restshape.application import Application, applications, as_scenes_see
from restshape.scene.formula_checks import check_formulas, check_units
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.scene.scene_parameters import Parameters
from restshape.scene.source import Source, suggestion
from restshape.scene.validation_errors import user_error


def read_effects(scene: Scene, application: Application, parameters: Parameters, source: Source) -> dict[str, Table]:
    """The plain tables of the effects by name, with all defaults.

    Args:
        scene: whose tables of effects are as they were written.
        application: of the scene.
        parameters: of the scene.
        source: for messages.

    Raises:
        UserError: an effect that there is not, or the first key or formula of one that makes no sense.
    """
    found = {}
    for name, settings in scene.effects.items():
        key = ("effects", name)
        if name not in application.effects:
            what = f"{application.name!r} has no effect {name!r}"
            raise source.error(key, what, _instead(name, scene, application))
        model = application.effects[name].model
        try:
            effect = model.model_validate(settings, context={"parameters": parameters})
        except ValidationError as error:
            raise user_error(error, source, model, key) from error
        check_formulas(effect, scene.parameters, source, key)
        check_units(effect, parameters, source, key)
        found[name] = effect.model_dump()
    return found


def _instead(name: str, scene: Scene, application: Application) -> str:
    """What to do about an effect that there is not: a near one, or an application that has all of the scene's."""
    do = suggestion(name, sorted(application.effects))
    others = [one.name for one in as_scenes_see(applications().values()) if scene.effects.keys() <= one.effects.keys()]
    return f'{do}, or app = "{others[0]}"' if others and do.startswith("use") else do
