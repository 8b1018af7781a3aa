"""`restshape schema`: the JSON schema of a scene or of an edit script, for editors."""

import argparse
import json
from functools import reduce
from operator import or_
from typing import Annotated, Any

from restshape.application import applications, as_scenes_see
from restshape.errors import UserError, one_line
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import SchemaFile

SUMMARY = "write the JSON schema of a scene or of a line of an edit script"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("of", metavar="scene|script", choices=("scene", "script"), help="what to describe")
    parser.add_argument("--out", metavar="FILE", type=SchemaFile, help="write into this file, not to the terminal")


def run(args: argparse.Namespace) -> int:
    """Writes the schema."""
    from restshape.scene.application_registry import refuse_clashes_of

    for app in applications().values():
        refuse_clashes_of(app)
    text = json.dumps(scene_schema() if args.of == "scene" else script_schema(), indent=1)
    if args.out:
        try:
            write_whole(args.out, text + "\n")
        except OSError as error:
            what = f"{args.out} cannot be written: {(error.strerror or str(error)).lower()}"
            raise UserError(what, "--out", "name another file") from error
        print(f"wrote {one_line(args.out)}")
    else:
        print(text)
    return 0


def scene_schema() -> dict[str, Any]:
    """The JSON schema of a scene, with the effects of all installed applications."""
    from restshape.scene.application_registry import installed_physics
    from restshape.scene.scene_type import any_scene_type

    schema = any_scene_type(installed_physics(applications().values())).model_json_schema()
    names = sorted(applications())
    schema["properties"]["app"] = {
        "enum": names,
        "title": "App",
        "description": "the application that simulates the scene",
    }
    effects = {name: _effect(name) for app in as_scenes_see(applications().values()) for name in app.effects}
    schema["properties"]["effects"] = {
        "type": "object",
        "description": "the effects that are simulated, each with its keys",
        "properties": effects,
        "additionalProperties": False,
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "restshape scene", **schema}


def _effect(name: str) -> dict[str, Any]:
    """The JSON schema of an effect: of any of the applications that know it, where they differ in its keys."""
    known = [app.effects[name] for app in as_scenes_see(applications().values()) if name in app.effects]
    models = list(dict.fromkeys(effect.model for effect in known))
    schemas = [model.model_json_schema() for model in models]
    return {"description": known[0].summary, **(schemas[0] if len(schemas) == 1 else {"anyOf": schemas})}


def script_schema() -> dict[str, Any]:
    """The JSON schema of one line of an edit script: the header, or an event of any installed application."""
    from pydantic import Field, TypeAdapter

    from restshape.scene.edit_script import Event, Header, events_of

    lines = Header | Event
    for app in as_scenes_see(applications().values()):
        if app.events:
            lines |= Annotated[reduce(or_, events_of(app).values()), Field(discriminator="do")]
    schema = TypeAdapter(lines).json_schema()
    title = "one line of a restshape edit script"
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **schema}
