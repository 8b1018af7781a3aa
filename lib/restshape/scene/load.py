"""Scenes from files: read, overridden, validated."""

# More than 15 modules: all that a scene is read, checked and made from meets here.

import re
import tomllib
from collections.abc import Sequence
from copy import deepcopy
from pathlib import Path

from pydantic import ValidationError

from restshape import bounds
from restshape.application import Application, application, application_of
from restshape.errors import UserError
from restshape.scene.changed_table import with_changed_table
from restshape.scene.checks import check_scene
from restshape.scene.darts import with_darts
from restshape.scene.foreign import check_keys
from restshape.scene.model import FORMAT, VERSION, MeshSpec, Scene, SolveSpec
from restshape.scene.overrides import branched, parse_override, put
from restshape.scene.panels import with_panels
from restshape.scene.plain_values import Table, excess
from restshape.scene.plan import plan
from restshape.scene.scene_effects import read_effects
from restshape.scene.scene_parameters import read_parameters
from restshape.scene.scene_type import scene_type
from restshape.scene.source import Source, read_text, split_key
from restshape.scene.validation_errors import user_error


def load_scene(path: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """The scene of a TOML file.

    Args:
        path: the file.
        overrides: ``"material.steel.E=70e9"`` and the like, applied before validation; a table may be a new entry:
            ``'supports.c={on="c",fix=["x"]}'``.

    Raises:
        UserError: naming file, key and line of what is wrong.
    """
    path = Path(path)
    text = read_text(path, "scene", bounds.SCENE_BYTES)
    raw = _tables(text, path)
    _refuse_excess(raw, Source(path, text))
    _check_format(raw, path)
    written = deepcopy(raw) if overrides else raw
    keys: list[tuple[str, ...]] = []
    named: list[str] = []
    for override in overrides:
        key, value = parse_override(override)
        put(raw, key, value, f"--set {override}", adds=isinstance(value, dict))
        keys.append(key)
        if len(key) > 1 and key[-1] == "file":
            named.append(str(value))
    source = Source(path, text, tuple(keys), tuple(named))
    if not overrides:
        return _scene(raw, source)
    _refuse_excess(raw, source)
    return _following(_scene(raw, source), written)


def _following(scene: Scene, written: Table) -> Scene:
    """A scene with overrides, with what its physics let follow from them.

    Args:
        scene: with overrides.
        written: its plain tables without them.
    """
    for physics in application_of(scene).physics:
        if not physics.overridden:
            continue
        try:
            before = _scene(written, Source(scene.path, scene._source.text))
        except UserError:
            # Without the overrides it is no scene.
            return scene
        raw = physics.followed(before, scene)
        scene = scene if raw is None else remade(scene, raw)
    return scene


def recorded_scene(raw: Table, path: Path) -> Scene:
    """The scene of plain tables that a recording holds.

    Args:
        raw: as `Scene.raw` gave them.
        path: for messages.

    Raises:
        UserError: they make no scene, or name a file.
    """
    return _of_tables(raw, Source(path, recorded=True))


def scene_of_tables(raw: Table, path: Path) -> Scene:
    """The scene of plain tables that a program has made.

    Args:
        raw: as a file would give them; they are the scene's from now on.
        path: of such a file: for messages, and where files that the scene names are looked for.

    Raises:
        UserError: they make no scene.
    """
    return _of_tables(raw, Source(path))


def _of_tables(raw: Table, source: Source) -> Scene:
    """The scene of plain tables from a source without a text."""
    _refuse_excess(raw, source)
    _check_format(raw, source.path)
    return _scene(raw, source)


def _tables(text: str, path: Path) -> Table:
    """The plain tables of a text.

    Raises:
        UserError: it is not TOML, or beyond what can be read.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(error, text, path) from error
    except RecursionError:
        what = f"there are more than {bounds.NESTING} tables and lists within each other"
        raise UserError(what, path.name, "write flatter tables") from None
    except ValueError as error:
        # Python reads no whole number of so many digits.
        digits = re.search(r"\d[\d_]{4000}", text)
        line = f" (line {text[: digits.start()].count(chr(10)) + 1})" if digits else ""
        raise UserError("a whole number has more than 4000 digits", path.name + line, "write a smaller one") from error


def _refuse_excess(raw: Table, source: Source) -> None:
    """Refuses tables with a value beyond a bound of all values.

    Raises:
        UserError: naming its key.
    """
    if found := excess(raw):
        key, what, do = found
        raise source.error([part[:40] for part in key[:4]], what, do)


def revise(scene: Scene, key: str, value: object) -> Scene:
    """The scene with one key changed, validated again; it shares all tables with the one given that stay as they are.

    Args:
        scene: is left as it is.
        key: dotted, such as ``material.steel.E``.
        value: as it would stand in the file; a table may be a new one among those that have names, such as a seam.

    Raises:
        UserError: there is no such key, or the value does not suit it.
    """
    parts = split_key(key)
    raw = branched(scene.raw, parts)
    put(raw, parts, value, f"set {key}", adds=isinstance(value, dict))
    revised = _scene(raw, scene._source.overriding(parts), scene)
    return _sharing(revised, scene, parts[0])


def without(scene: Scene, key: str) -> Scene:
    """The scene without one of its tables, which it need not have; else as of `revise`.

    Raises:
        UserError: it cannot be left out.
    """
    raw = {name: value for name, value in scene.raw.items() if name != key}
    return _sharing(_scene(raw, scene._source, scene), scene, key)


def _sharing(revised: Scene, scene: Scene, changed: str) -> Scene:
    """A scene that shares with the one before all tables that stay as they are, when one of them has changed."""
    # Formulas elsewhere may depend on a parameter; panels and darts make the shape, and darts seams.
    every = changed == "parameters" or changed in revised.tables.values()
    others = [name for name in type(scene).model_fields if name != changed]
    shared = {n: getattr(scene, n) for n in others if not every or getattr(scene, n) == getattr(revised, n)}
    if revised.mesh.order != scene.mesh.order:
        # The change makes the plan decide on another order.
        shared.pop("mesh", None)
    if revised.solve.tolerance != scene.solve.tolerance:
        shared.pop("solve", None)
    return revised.model_copy(update=shared)


def remade(scene: Scene, raw: Table) -> Scene:
    """The scene of other plain tables in place of its own, validated again.

    Raises:
        UserError: they make no scene.
    """
    return _scene(raw, scene._source)


def _syntax_error(error: tomllib.TOMLDecodeError, text: str, path: Path) -> UserError:
    """The error for people of text that is not TOML."""
    message = str(error)
    what, _, place = message.partition(" (at ")
    place = place.rstrip(")")
    where = f"{path.name} ({place})" if place else path.name
    if "overwrite" in what or "twice" in what or "Duplicate" in what:
        return UserError("a name or key is used twice", where, "rename or remove one of the two")
    if text.lstrip().startswith("{"):
        return UserError("this is JSON, as edits are, and no scene", where, "name the scene first, then its edits")
    sign = _sign_at(text, place)
    letter = sign.isalpha() and not sign.isascii()
    do = f"write keys with {sign!r} in quotes" if letter else "see https://toml.io for the syntax"
    return UserError(f"this is not TOML: {what[0].lower()}{what[1:]}", where, do)


def _sign_at(text: str, place: str) -> str:
    """The character of a text at a place such as ``line 3, column 5``; empty where there is none."""
    found = re.fullmatch(r"line (\d+), column (\d+)", place)
    line = text.split("\n")[int(found[1]) - 1] if found else ""
    return line[int(found[2]) - 1 :][:1] if found else ""


def _check_format(raw: Table, path: Path) -> None:
    """Refuses a file that says it is something else, or of another version."""
    if raw.get("format") != FORMAT:
        found = f"its format is {raw['format']!r}" if "format" in raw else "it has no format"
        raise UserError(f"this is not a scene: {found}", f"{path.name}: format", f'begin it with format = "{FORMAT}"')
    if raw.get("version") != VERSION:
        found = f"version {raw['version']!r}" if "version" in raw else "no version"
        raise UserError(f"the scene has {found}", f"{path.name}: version", f"this program reads version = {VERSION}")


def _scene(raw: Table, source: Source, before: Scene | None = None) -> Scene:
    """The validated scene of plain tables; of those that are the very tables of a scene before some work is spared."""
    # Which tables there may be is known from the application, where the scene names one.
    named = raw.get("app")
    app = application(named, f"{source.path.name}: app").for_scene(raw) if isinstance(named, str) else None
    if app:
        check_keys(raw, app, source)
    kind = scene_type(tuple(app.physics)) if app else Scene
    parameters = read_parameters(raw, source)
    known = {"parameters": parameters, "folder": source.path.parent}
    read = with_changed_table(before, raw, kind, known) if before else None
    if read is None:
        try:
            read = kind.model_validate(raw, context=known)
        except ValidationError as error:
            raise user_error(error, source, kind) from error
    assert app, "a scene without an application is not valid"
    try:
        scene = with_darts(with_panels(read))
    except UserError as error:
        raise source.error(split_key(error.where), error.what, error.do) from error
    stay = before is not None and all(raw.get(key) is before.raw.get(key) for key in ("parameters", "effects"))
    effects = before.effects if before and stay else read_effects(scene, app, parameters, source)
    scene = scene.model_copy(update={"effects": effects})
    check_scene(scene, app, source, parameters)
    scene._source, scene._raw, scene._as_read = source, raw, read
    return _decided(scene, app)


def _decided(scene: Scene, app: Application) -> Scene:
    """The scene with the element order and the tolerance that its plan decides, where it names none."""
    try:
        planned = plan(scene, app)
    except UserError as error:
        raise scene.located(error) from None
    update: dict[str, MeshSpec | SolveSpec] = {}
    if scene.mesh.order != planned.order:
        update["mesh"] = scene.mesh.model_copy(update={"order": planned.order})
    if planned.tolerance is not None and "tolerance" not in scene.solve.model_fields_set:
        update["solve"] = scene.solve.model_copy(update={"tolerance": planned.tolerance})
    return scene.model_copy(update=update) if update else scene
