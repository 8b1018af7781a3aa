"""Pages of docs/ link to what is there, name files that exist, have tables that fit, and scenes that are valid."""

import re
import tomllib
from argparse import ArgumentParser
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError
from schema_check import fits

from restshape.application import applications
from restshape.cli.main import command_parser, named_command
from restshape.cli.schema import scene_schema
from restshape.errors import UserError
from restshape.scene.application_registry import installed_physics
from restshape.scene.load import load_scene
from restshape.scene.model import ShapeSpec
from restshape.scene.scene_parameters import Parameters, read_parameters
from restshape.scene.scene_type import any_scene_type, scene_type
from restshape.scene.source import Source
from restshape.scene.values import annotation_of
from restshape.shape.build import outline_from_spec

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SOURCES = ("lib", "apps", "studies", "verification", "tests", "scripts")
CELL = 160
"""Characters in two lines of a table's cell."""


def slug(heading: str) -> str:
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")


def prose(page: Path) -> str:
    """The text of a page without its code blocks."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)


def anchors(page: Path) -> set[str]:
    return {slug(heading) for heading in re.findall(r"^#+ (.*)$", prose(page), re.M)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_to_files_and_headings(page):
    for link in re.findall(r"""(?:\]\(|src=")([^)"\s]+)""", prose(page)):
        if "://" in link:
            continue
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_cells_of_tables_fit_two_lines(page):
    for line in prose(page).splitlines():
        if line.startswith("|"):
            cells = [re.sub(r"<img[^>]*>|\]\([^)]*\)", "", cell).strip() for cell in re.split(r"(?<!\\)\|", line)]
            assert max(map(len, cells)) <= CELL, line


WORDS = 45
"""In a sentence at most."""


def sentences(page: Path) -> Iterator[str]:
    """The sentences of paragraphs and of items of lists; code and formulas as one word, links as their text."""
    text = re.sub(r"\$\$.*?\$\$", "x", prose(page), flags=re.S)
    # Tables and headings end a paragraph; of a key of the reference, what it is counts, not its type.
    text = re.sub(r"^ *(\||#).*$", "", text, flags=re.M)
    text = re.sub(r"^ *(?:[-*]|\d+\.) (?:`\w+` \((?:\[[^]]*\]\([^)]*\)|[^()])*\):)?", "\n\n", text, flags=re.M)
    for paragraph in re.split(r"\n\s*\n", text):
        plain = re.sub(r"!?\[([^]]*)\]\([^)]*\)", r"\1", " ".join(paragraph.split()))
        plain = re.sub(r"`[^`]*`|\$[^$]*\$|<[^>]*>", "x", plain)
        yield from re.split(r"(?<=[.!?])[*)\"]*\s+(?=\W*[A-Zx0-9])", plain)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_sentences_are_short(page):
    long = {one: len(one.split()) for one in sentences(page) if len(one.split()) > WORDS}
    assert not long, "\n".join(f"{count} words: {one}" for one, count in long.items())


def test_sentences_are_found(tmp_path):
    page = tmp_path / "page.md"
    lines = ("# A heading. With two", "One two", "three ([a link](x.md)): four. `Five six` is", "$a b$. Six", "")
    rest = (
        "| a | cell. Of |",
        "- item one; item",
        "  two. Three",
        "- `key` (text or [table](#a)): four",
        "```",
        "c. D",
        "```",
    )
    page.write_text("\n".join((*lines, *rest)), encoding="utf-8")
    found = [one for one in sentences(page) if one.strip()]
    assert found == ["One two three (a link): four.", "x is x.", "Six", "item one; item two.", "Three", "four"]


def test_source_files_that_pages_name_exist():
    there = ["/" + path.as_posix() for folder in SOURCES for path in (ROOT / folder).rglob("*.*")]
    for page in PAGES:
        for name in re.findall(r"`([\w./]+\.(?:py|hpp))`", prose(page)):
            assert "NAME" in name or any(path.endswith("/" + name) for path in there), (page.name, name)


SHIPPED = {path.parent.name for path in (ROOT / "apps").glob("*/__init__.py")}
BLOCKS = [
    (f"{page.relative_to(ROOT)}:{page.read_text(encoding='utf-8')[: found.start()].count(chr(10)) + 1}", found[1])
    for page in PAGES
    for found in re.finditer(r"^```toml\n(.*?)^```$", page.read_text(encoding="utf-8"), re.S | re.M)
]


def validate_part(tables: dict[str, Any]) -> None:
    """Refuses what is no part of a scene: of the application that it names, else of any that is installed.

    Raises:
        ValidationError: a key or a value that its table does not have.
        KeyError: a table, an application or an effect that does not exist.
    """
    installed = applications()
    apps = [installed[tables["app"]]] if "app" in tables else list(installed.values())
    kind = scene_type(apps[0].physics) if "app" in tables else any_scene_type(installed_physics(apps))
    known = parameters_of(tables)
    for key, table in tables.items():
        if key != "shape" or table:
            TypeAdapter(annotation_of(kind.model_fields[key])).validate_python(table, context=known)
    for name, settings in tables.get("effects", {}).items():
        models = [app.effects[name].model for app in apps if name in app.effects]
        errors = [error for model in models if (error := refusal(model, settings, known))]
        if len(errors) == len(models):
            raise errors[0] if errors else KeyError(name)


def parameters_of(tables: dict[str, Any]) -> dict[str, Parameters]:
    """What formulas of tables are made of, for their validation."""
    return {"parameters": read_parameters(tables, Source(Path("part.toml")))}


def refusal(model: Any, settings: object, known: dict[str, Parameters]) -> ValidationError | None:
    """What a model finds wrong with settings; None where nothing is."""
    try:
        model.model_validate(settings, context=known)
    except ValidationError as error:
        return error
    return None


@pytest.mark.skipif(not set(applications()) >= SHIPPED, reason="pages show scenes of applications that are absent")
@pytest.mark.parametrize(("place", "text"), BLOCKS, ids=[place for place, _ in BLOCKS])
def test_scenes_and_parts_of_them_are_valid(place, text, tmp_path):
    tables = tomllib.loads(text)
    if "format" in tables:
        (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
        if "file" in tables.get("shape", {}):
            # Drawings that commands of the page have written.
            (tmp_path / tables["shape"]["file"]).touch()
        load_scene(tmp_path / "scene.toml")
    else:
        validate_part(tables)
    if tables.get("shape", {}).get("outline"):
        spec = ShapeSpec.model_validate(tables["shape"], context=parameters_of(tables))
        assert outline_from_spec(spec, tmp_path).area() > 0.0


@pytest.mark.skipif(not set(applications()) >= SHIPPED, reason="pages show scenes of applications that are absent")
def test_scenes_and_parts_of_them_fit_the_schema():
    schema = scene_schema()
    for place, text in [
        *BLOCKS,
        ("mesh.unit", "[mesh]\nfile = 'a.msh'\nunit = 'mm'\n"),
        ("", "[mesh]\nunit = 0.001\n"),
    ]:
        tables = tomllib.loads(text)
        part = schema if "format" in tables else {**schema, "required": []}
        assert fits(tables, part, schema), place


@pytest.mark.parametrize("text", ["[mesh]\nunit = true", "[mesh]\nunits = 'mm'", "[mesh]\nunit = -1", "version = 2"])
def test_what_does_not_fit_the_schema_is_found(text):
    schema = scene_schema()
    assert not fits(tomllib.loads(text), {**schema, "required": []}, schema)


@pytest.mark.parametrize(
    "text",
    [
        "[shap]\noutline = ['a']",
        "[shape.edges]\nbottom = { lin = ['a', 'b'] }",
        "[mesh]\nsize = '2 kg'",
        "[effects.no_such]",
        "[quantities]\nq = { no_such = true }",
        "[solve]\ntolerance = 2",
    ],
)
def test_what_is_no_part_of_a_scene_is_found(text):
    with pytest.raises((ValidationError, KeyError, UserError)):
        validate_part(tomllib.loads(text))


def options_of(name: str) -> set[str]:
    """The options of a command, and of those within it."""
    parsers, found = [command_parser(name, *named_command(name, []))], set()
    while parsers:
        for action in parsers.pop()._actions:
            found.update(action.option_strings)
            inner = action.choices
            parsers += (
                [one for one in inner.values() if isinstance(one, ArgumentParser)] if isinstance(inner, dict) else []
            )
    return found


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_commands_of_pages_have_the_options_that_are_named(page):
    """In code blocks, and in code within sentences and tables, which may leave `restshape` out."""
    text = page.read_text(encoding="utf-8")
    for name, rest in re.findall(r"\brestshape ([a-z][a-z-]*)((?:\\\n|[^`\n|#])*)", text):
        if named_command(name, []):
            missing = set(re.findall(r"(?<=\s)--[a-z][a-z-]*", rest.split(" -- ")[0])) - options_of(name)
            assert not missing, f"restshape {name}: {missing}"
    for name, option in re.findall(r"`([a-z][a-z-]*) (--[a-z][a-z-]*)", text):
        if name not in OTHER_PROGRAMS:
            assert named_command(name, []) and option in options_of(name), f"{name} {option}"


OTHER_PROGRAMS = {"restshape", "pytest", "mpiexec", "make", "git", "ruff", "pip", "python"}
