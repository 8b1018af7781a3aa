"""Keys of a scene that belong to the physics of other applications than its own."""

from restshape.application import Application, applications, as_scenes_see
from restshape.errors import UserError
from restshape.scene.application_registry import refuse_clashes_of
from restshape.scene.declared_keys import declared_keys, known_keys, names_of, written_keys
from restshape.scene.plain_values import Table, table_in
from restshape.scene.source import Source


def check_keys(raw: Table, application: Application, source: Source) -> None:
    """Refuses keys that only other applications have, and applications that have two meanings of one.

    Args:
        raw: plain tables of a scene.
        application: of the scene.
        source: for messages.

    Raises:
        UserError: the first of them; it names an application that has it.
    """
    refuse_clashes_of(application)
    _check_instead(raw, application, source)
    known = known_keys(tuple(application.physics))
    for what, key, place in written_keys(raw):
        if key in known[what]:
            continue
        for other in as_scenes_see(applications().values()):
            owner = next((one for one in other.physics if key in declared_keys(one)[what]), None)
            if owner is not None:
                first = next(iter(table_in(raw, key)), None) if what == "table" and owner.sections[key].named else None
                raise _error(what, key, (*place, first) if first else place, application, other, source)


def _check_instead(raw: Table, application: Application, source: Source) -> None:
    """Refuses tables in place of which the application has others."""
    for physics in application.physics:
        for table, do in physics.instead.items():
            for name in table_in(raw, table):
                raise source.error((table, name), f"the application {application.name!r} has no [{table}.NAME]", do)


def _error(
    what: str, key: str, place: tuple[str, ...], application: Application, other: Application, source: Source
) -> UserError:
    """The error of a key that another application has."""
    own = names_of(application.physics, what)
    if what == "direction" and own:
        do = f"use some of: {', '.join(own)}"
    elif what.endswith("kind") and own:
        do = f'use one of: {", ".join(own)}, or app = "{other.name}"'
    elif other.name == application.name:
        do = f"leave it out, or add {' or '.join(f'[{table}]' for table in application.kinds)}"
    else:
        do = f'leave it out, or use app = "{other.name}"'
    what_is_wrong = f"knows no {what} {key!r}" if what == "direction" else f"has no {what} {key!r}"
    return source.error(place, f"the application {application.name!r} {what_is_wrong}", do)
