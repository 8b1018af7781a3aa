"""Keys of a scene that belong to another application than its own."""

from typing import Any

from restshape.application import Application
from restshape.scene.registered import extended_applications
from restshape.scene.source import Source


def refuse_foreign(raw: dict[str, Any], application: Application, source: Source) -> None:
    """Refuses tables and quantities that only other applications have.

    Args:
        raw: plain tables of a scene.
        application: of the scene.
        source: for messages.

    Raises:
        UserError: the first of them; it names an application that has it.
    """
    own = application.scene
    quantities = raw.get("quantities")
    held = quantities.items() if isinstance(quantities, dict) else ()
    for other in extended_applications().values():
        if other.scene is own:
            continue
        tables = [key for key in other.scene.sections if key in raw and not (own and key in own.sections)]
        kinds = [kind for kind in other.scene.quantities if not (own and kind in own.quantities)]
        places = [((key,), f"table {key!r}") for key in tables]
        places += [
            (("quantities", name, kind), f"quantity of the kind {kind!r}")
            for name, keys in held
            for kind in kinds
            if isinstance(keys, dict) and kind in keys
        ]
        for key, what in places:
            do = f'leave it out, or use app = "{other.name}"'
            raise source.error(key, f"the application {application.name!r} has no {what}", do)
