"""Validation errors of pydantic, as plain messages."""

import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails
from typing_extensions import is_typeddict

from restshape.errors import UserError, ValueProblem
from restshape.scene.source import Source, suggestion
from restshape.scene.units import reads_as_quantity

MAX_REPORTED = 4
TABLES_OR_TRUTHS = ("dict_type", "model_type", "bool_type", "bool_parsing")
"""Kinds of findings where what stands in quotes may be meant without: `error` is a key beside names of quantities."""
BOUNDS = {
    "greater_than": ("small", "greater than", "a number above", "gt"),
    "greater_than_equal": ("small", "at least", "at least", "ge"),
    "less_than": ("large", "less than", "a number below", "lt"),
    "less_than_equal": ("large", "at most", "at most", "le"),
}
"""Of numbers beyond their bound: what they are, must be, what to give, and where pydantic has the bound."""


def user_error(
    error: ValidationError, source: Source, root: type[BaseModel], prefix: tuple[str, ...] = ()
) -> UserError:
    """The one error for people that shows what a validation found.

    Args:
        error: as pydantic raised it.
        source: the text that was validated, to find lines in.
        root: the model that it was validated against.
        prefix: key of that model in the file.
    """
    # an unknown key is often what makes another one missing: report it first
    found = sorted(whole_lists(error.errors(include_url=False)), key=lambda e: e["type"] != "extra_forbidden")
    reported = [_reported(details, source, root, prefix) for details in found[:MAX_REPORTED]]
    first = reported[0]
    # What is to be done about all of them is said once.
    remedies = [f" ({other.do})" * bool(other.do and other.do != first.do) for other in reported[1:]]
    others = [f"  also {other.where}: {other.what}{remedy}" for other, remedy in zip(reported[1:], remedies)]
    if len(found) > MAX_REPORTED:
        others.append(f"  and {len(found) - MAX_REPORTED} more")
    return UserError("\n".join([first.what, *others]), first.where, first.do)


def _reported(details: ErrorDetails, source: Source, root: type[BaseModel], prefix: tuple[str, ...]) -> UserError:
    """One finding as an error with key, line and suggestion."""
    location = details["loc"]
    key = [
        *prefix,
        *(part for part in location if not (isinstance(part, str) and part.startswith("<")) and part != "[key]"),
    ]
    if _lacks_an_entry(details):
        key = key[:-1]
    what, do = plain(details)
    match details["type"]:
        case "missing" if len(location) == 1 and (inner := known_keys(root, location)):
            return source.error(key, f"the table [{location[0]}] is missing", f"add it; its keys: {', '.join(inner)}")
        case "extra_forbidden":
            known = known_keys(root, location[:-1])
            do = f"write [shape.{key[0]}]" if tuple(key) in IN_SHAPE else suggestion(str(key[-1]), known)
            return source.error(key, f"there is no key {str(key[-1])!r} here", do)
        case "kind" if isinstance(details["input"], list) and "loop" in _keys(details):
            return source.error(key, what, f"write {{ loop = {json.dumps(details['input'], default=str)} }}")
        case "kind" if isinstance(details["input"], dict) and details["input"]:
            unknown = next(iter(details["input"]))
            return source.error(key, what, suggestion(str(unknown), _keys(details)))
        case "literal_error" if isinstance(details["input"], str):
            expected = details["ctx"]["expected"].replace(" or ", ", ").replace("'", "").split(", ")
            return source.error(key, what, suggestion(details["input"], expected))
    return source.error(key, what, do)


def _keys(details: ErrorDetails) -> list[str]:
    """The keys of which one says what kind of table is meant."""
    return str(details["ctx"]["keys"]).split(", ")


IN_SHAPE = [(key,) for key in ("outline", "vertices", "edges", "holes", "regions", "points", "groups")]
"""Keys of [shape], where they stand at the top of a scene."""
AXES = {2: "two numbers [x, y]", 3: "three numbers [x, y, z]"}
"""Lists of numbers that are most often wanted, by their count."""
EDGES, VERTICES = ("line", "arc", "spline", "polyline"), 'the names of two vertices ["a", "b"]'
"""Kinds of edges, whose lists are no numbers, and what these lists hold."""


def whole_lists(found: Sequence[ErrorDetails]) -> list[ErrorDetails]:
    """The findings, with one for each list that is too short, at the first place that it lacks, with its full count.

    A list is not too short because pydantic leaves out the entries of it that are wrong.
    """
    found = [details for details in found if not _has_all_entries(details)]
    counts: dict[tuple[str | int, ...], int] = {}
    for details in found:
        if _lacks_an_entry(details):
            *place, number = details["loc"]
            counts[tuple(place)] = max(counts.get(tuple(place), 0), int(number) + 1)
    reported = []
    for details in found:
        if not _lacks_an_entry(details):
            reported.append(details)
        elif count := counts.pop(tuple(details["loc"][:-1]), 0):
            reported.append({**details, "ctx": {"count": count}})
    return reported


def _has_all_entries(details: ErrorDetails) -> bool:
    """Whether a finding calls a list too short that has as many entries as are wanted."""
    given = details["input"]
    return details["type"] == "too_short" and isinstance(given, list) and len(given) >= details["ctx"]["min_length"]


def _lacks_an_entry(details: ErrorDetails) -> bool:
    return details["type"] == "missing" and isinstance(details["loc"][-1], int)


def plain(details: ErrorDetails) -> tuple[str, str]:
    """What one finding says in plain words, and what to do about it."""
    kind, given, context = details["type"], details["input"], details.get("ctx", {})
    shown = f"not {_shown(given)}"
    match kind:
        case "missing" if isinstance(details["loc"][-1], int):
            count = context["count"]
            wanted = VERTICES if details["loc"][-2] in EDGES else AXES.get(count, f"{count} entries")
            what = f"{wanted} are wanted here, and there are fewer"
            return what, _of_length(given, count)
        case "missing":
            return f"the key {str(details['loc'][-1])!r} is missing", "add it"
        case "value_error":
            error = context["error"]
            return (error.what, error.do) if isinstance(error, ValueProblem) else (str(error), "")
        case "kind":
            return f"{details['msg']}, {shown}", ""
        case "literal_error" if context["expected"] == "True" and given is False:
            return "true is wanted here, not false", "leave the key out where it is not so"
        case "literal_error":
            return f"{context['expected']} is wanted here, {shown}", ""
        case "finite_number":
            return f"{given} is not a finite number", "write a finite number"
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal":
            return _beyond(kind, given, context)
        case "too_short" | "too_long":
            limit = context["min_length" if kind == "too_short" else "max_length"]
            bound = "at least" if kind == "too_short" else "at most"
            entries = "1 entry is" if limit == 1 else f"{limit} entries are"
            what = f"{bound} {entries} wanted here, but there are {context['actual_length']}"
            return what, _of_length(given, limit)
        case _ if kind in TABLES_OR_TRUTHS and given in ("true", "false"):
            return f"{given} is no text here", f"drop the quotes: write {given}"
        case "bool_type" | "bool_parsing":
            return f"true or false is wanted here, {shown}", "write true or false, without quotes"
        case "dict_type" | "model_type":
            if not isinstance(given, bool):
                return f"a table of keys is wanted here, {shown}", ""
            name = "".join(str(part) for part in details["loc"][-1:]) or "it"
            do = f"write {name} = {{}}" if given else f"leave {name} out: what a scene does not name is off"
            return f"a table of keys is wanted here, {shown}", do
        case "list_type" | "tuple_type":
            single = isinstance(given, str | int | float) and not isinstance(given, bool)
            # A number alone is hardly ever all that a list of numbers wants.
            whole = ("all of its numbers", "0, ") if _is_quantity(given) else ("it", "")
            shown_in = f"[{whole[1]}{json.dumps(given, ensure_ascii=False)}]"
            written = f"write {whole[0]} in brackets, as in {shown_in}" if single else ""
            if isinstance(given, str) and given.startswith("["):
                written = 'put each text in it in quotes, as in [0, "5 kN"]'
            if isinstance(given, dict):
                written = "write a list in brackets in place of the table in braces"
            return f"a list is wanted here, {shown}", written
        case "string_type":
            several = isinstance(given, list) and given and all(isinstance(one, str) for one in given)
            do = "write one name; [shape.groups] gives several of a shape one name" if several else ""
            return f"text in quotes is wanted here, {shown}", do
        case "float_type" | "float_parsing" | "int_type" | "int_parsing" | "int_from_float":
            return f"a {'whole ' * kind.startswith('int')}number is wanted here, {shown}", ""
    return f"{details['msg']}, {shown}", ""


def _beyond(kind: str, given: object, context: Mapping[str, float]) -> tuple[str, str]:
    """What to say of a number beyond the bound of a key, and what to do."""
    size, must, give, key = BOUNDS[kind]
    bound = f"{context[key]:g}"
    return f"{_shown(given)} is too {size}: it must be {must} {bound}", f"give {give} {bound}"


def _of_length(given: object, count: int) -> str:
    """What to write in place of a list of numbers that is too short or too long; empty where it holds other things."""
    if not isinstance(given, list | tuple) or not given or not all(_is_quantity(one) for one in given):
        return ""
    entries = [*given[:count], *[given[-1]] * (count - len(given))]
    return f"write {count}, as in {json.dumps(entries, ensure_ascii=False)}"


def _is_quantity(value: object) -> bool:
    """Whether it is a number, or text that reads as one."""
    if isinstance(value, str):
        return reads_as_quantity(value)
    return isinstance(value, int | float) and not isinstance(value, bool)


def _shown(given: object) -> str:
    """What was given, short."""
    text = repr(given)
    return text if len(text) <= 60 else f"{text[:57]}..."


def known_keys(root: object, location: Sequence[str | int]) -> list[str]:
    """The keys of the model at a place, found by walking the annotations; empty where there is no model."""
    kind = root
    for part in location:
        kind = _step(kind, part)
        if kind is None:
            return []
    if components := _components(kind):
        return list(components)
    return [field.alias or name for model in _models(kind) for name, field in model.model_fields.items()]


def _components(kind: object) -> Mapping[str, object]:
    """The annotations of a table that is no model, by key."""
    inner = get_args(kind)[0] if get_origin(kind) is Annotated else kind
    return inner.__annotations__ if is_typeddict(inner) else {}


def _step(kind: object, part: str | int) -> object:
    """The annotation one key further in, or None."""
    origin, arguments = get_origin(kind), get_args(kind)
    if components := _components(kind):
        return components.get(str(part))
    if origin is Annotated:
        return _step(arguments[0], part)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind.model_fields[part].annotation if part in kind.model_fields else None
    if origin is dict:
        return arguments[1]
    if origin in (list, tuple):
        return arguments[0]
    if isinstance(part, str) and part.startswith("<"):
        return next((option for option in arguments if Tag(part) in getattr(option, "__metadata__", ())), None)
    models = _models(kind)
    return _step(models[0], part) if models else None


def _models(kind: object) -> list[type[BaseModel]]:
    """The models that an annotation may be."""
    origin = get_origin(kind)
    if origin is Annotated:
        return _models(get_args(kind)[0])
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind]
    if origin is Union or type(kind).__name__ == "UnionType":
        return [model for option in get_args(kind) for model in _models(option)]
    return []
