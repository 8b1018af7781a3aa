"""Whether a JSON value fits a JSON schema, as far as the schemas of scenes and scripts go."""

from typing import Any

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def fits(value: Any, schema: Any, root: dict[str, Any]) -> bool:
    """Whether a value fits a schema.

    Args:
        value: of JSON or TOML.
        schema: of it, or a part of one; root: where its references point to.
    """
    if isinstance(schema, bool):
        return schema
    if "$ref" in schema:
        target: Any = root
        for part in schema["$ref"].removeprefix("#/").split("/"):
            target = target[part]
        return fits(value, target, root)
    choices = [
        any(fits(value, one, root) for one in schema.get("anyOf", schema.get("oneOf", [True]))),
        all(fits(value, one, root) for one in schema.get("allOf", [])),
        "const" not in schema or value == schema["const"],
        "enum" not in schema or value in schema["enum"],
    ]
    return all(choices) and _is(value, schema.get("type")) and _bounded(value, schema) and _holds(value, schema, root)


def _is(value: Any, kind: str | None) -> bool:
    if kind is None:
        return True
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if kind in ("number", "integer"):
        return number and (kind == "number" or float(value).is_integer())
    return isinstance(value, TYPES[kind])


def _bounded(value: Any, schema: dict[str, Any]) -> bool:
    if isinstance(value, int | float) and not isinstance(value, bool):
        least, most = schema.get("minimum", value), schema.get("maximum", value)
        above, below = schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum")
        return least <= value <= most and (above is None or value > above) and (below is None or value < below)
    if isinstance(value, list):
        return schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value))
    return True


def _holds(value: Any, schema: dict[str, Any], root: dict[str, Any]) -> bool:
    if isinstance(value, list):
        first = schema.get("prefixItems", [])
        parts = all(fits(one, part, root) for one, part in zip(value, first))
        return parts and all(fits(one, schema.get("items", True), root) for one in value[len(first) :])
    if not isinstance(value, dict):
        return True
    known, rest = schema.get("properties", {}), schema.get("additionalProperties", True)
    return set(schema.get("required", ())) <= set(value) and all(
        fits(one, known.get(key, rest), root) for key, one in value.items()
    )
