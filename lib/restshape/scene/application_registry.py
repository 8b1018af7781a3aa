"""Keys of the scenes of an application, each of which has one meaning; those of another may have another."""

from collections.abc import Iterable, Iterator
from functools import cache
from typing import NoReturn

from restshape.application import Application, as_scenes_see
from restshape.errors import UserError
from restshape.scene.declared_keys import core_keys, declared_keys
from restshape.scene.edit_script import shared_events
from restshape.scene.physics import Physics
from restshape.scene.units import SYMBOLS


def refuse_clashes_of(app: Application) -> None:
    """Makes sure that each key of an application's scenes has one meaning, whatever else is installed.

    Raises:
        UserError: two of its physics give one key different meanings, or one of them has a key of all scenes.
    """
    for seen in app.as_seen:
        _refuse_clashes_once(tuple(seen.physics))
        _refuse_clashes_within(seen)


def installed_physics(applications: Iterable[Application]) -> list[Physics]:
    """The physics of applications, each once."""
    return list(dict.fromkeys(one for app in as_scenes_see(applications) for one in app.physics))


@cache
def _refuse_clashes_once(physics: tuple[Physics, ...]) -> None:
    """Makes sure of it once: edits make scenes many times a second."""
    refuse_clashes(physics)


def refuse_clashes(physics: Iterable[Physics]) -> None:
    """Makes sure that each key of scenes has one meaning.

    Raises:
        UserError: two physics declare a key with different meanings, or one declares what all scenes have.
    """
    physics, core = list(physics), core_keys()
    for one in physics:
        for what, meanings in declared_keys(one).items():
            if taken := core.get(what, frozenset()).intersection(meanings):
                _refuse(one.name, what, min(taken), "every scene has one")
    for (what, key), (owner, known), (name, meaning) in _clashes(physics):
        _refuse(name, what, key, f"{owner!r} does too{_dimensions((name, meaning), (owner, known))}")


def clashes_with(app: Application, others: Iterable[Application]) -> list[str]:
    """The keys of an application that mean another thing in scenes of others, a line each."""
    own = {one.name for one in installed_physics([app])}
    return [
        f"the {what} {key!r} of {owner!r} means another thing in {name!r}{_dimensions((name, meaning), (owner, known))}"
        for (what, key), (owner, known), (name, meaning) in _clashes(installed_physics([app, *others]))
        if owner in own
    ]


def _clashes(
    physics: Iterable[Physics],
) -> Iterator[tuple[tuple[str, str], tuple[str, object], tuple[str, object]]]:
    """What a key is and its name, then the names of two physics with what each means by it."""
    owners: dict[tuple[str, str], tuple[str, object]] = {}
    for one in physics:
        for what, meanings in declared_keys(one).items():
            for key, meaning in meanings.items():
                first = owners.setdefault((what, key), (one.name, meaning))
                if first[1] != meaning:
                    yield (what, key), first, (one.name, meaning)


def _refuse_clashes_within(app: Application) -> None:
    """Makes sure that each effect, event and column of an application is that of one of its physics."""
    owners: dict[tuple[str, str], tuple[str, object]] = {}
    shared = shared_events(app)
    for one in app.physics:
        for key, model in one.events.items():
            if shared.get(key, model) is not model:
                _refuse(one.name, "event", key, "its edit scripts have one")
        for what, added in (("event", one.events), ("effect", one.effects)):
            for key, meaning in added.items():
                owner, known = owners.setdefault((what, key), (one.name, meaning))
                if known is not meaning:
                    _refuse(one.name, what, key, f"{owner!r} does too")


def _dimensions(*meanings: tuple[str, object]) -> str:
    """What two physics mean by a key, where their dimensions differ: else nothing."""
    named = {owner: _dimension(meaning) for owner, meaning in meanings}
    differ = all(named.values()) and len({*named.values()}) > 1
    return ": " + ", ".join(f"{one} in {owner!r}" for owner, one in named.items()) if differ else ""


def _dimension(meaning: object) -> str:
    """The dimension of what a key means, with its unit; empty where it is no number."""
    name = meaning[0] if isinstance(meaning, tuple) and meaning else meaning
    return f"{name} [{SYMBOLS[name] or 1}]" if isinstance(name, str) and name in SYMBOLS else ""


def _refuse(name: str, what: str, key: str, other: str) -> NoReturn:
    raise UserError(f"{name!r} adds the {what} {key!r}, and {other}", name, "give one another key, or uninstall it")
