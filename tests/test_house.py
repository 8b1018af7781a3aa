"""The library names no application, no class knows too much, and a name means one thing."""

import ast
import re
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

LIBRARY = Path(__file__).parents[1] / "lib" / "restshape"
KERNELS = Path(__file__).parents[1] / "lib" / "kernels"
WORDS = re.compile(r"restshape_apps|plank|furnitur|fastener|\bnails?\b", re.IGNORECASE)


def test_the_library_names_no_application_and_no_plank():
    for path in LIBRARY.rglob("*.py"):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            assert not WORDS.search(line), f"{path}:{number}: {line}"


def test_the_library_reads_no_settings_but_those_that_its_own_physics_declare():
    from restshape.application import applications
    from restshape.scene.application_registry import installed_physics

    declared = {
        name
        for physics in installed_physics(applications().values())
        for name, effect in physics.effects.items()
        if effect.model.__module__.startswith("restshape.physics.")
    }
    read = {
        name
        for path in LIBRARY.rglob("*.py")
        for name in re.findall(r"""settings\(["'](\w+)["']\)""", path.read_text(encoding="utf-8"))
    }
    assert {"solid", "modal", "cloth"} <= read <= declared


ROOMS = (LIBRARY, *(LIBRARY.parents[1] / name for name in ("apps", "studies", "verification")))
MOST = 15
EXCUSED_MODULES = re.compile(r"^# More than 15 modules: \w", re.MULTILINE)
EXCUSED_ATTRIBUTES = re.compile(r"^ *# More than 15 attributes: \w")
STANDARD = sys.stdlib_module_names


def imported(tree: ast.Module) -> set[str]:
    """Modules that a file imports, but those of the standard library."""
    plain = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    named = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    return {name for name in plain | named if name.split(".")[0] not in STANDARD}


def name_of(node: ast.expr) -> str:
    """The name that an expression is; empty where it is another one."""
    return node.id if isinstance(node, ast.Name) else ""


def attributes(kind: ast.ClassDef) -> set[str]:
    """What instances of a class hold: its fields, and what its methods set of themselves."""
    fields = {
        node.target.id
        for node in kind.body
        if isinstance(node, ast.AnnAssign) and not ast.unparse(node.annotation).startswith("ClassVar")
    }
    return fields | {
        node.attr
        for node in ast.walk(kind)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and name_of(node.value) == "self"
    }


Classes = dict[str, ast.ClassDef]


def classes_of(tree: ast.Module) -> Classes:
    """The classes of a module by name."""
    return {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}


def all_attributes(kind: ast.ClassDef, own: Classes, known: Classes) -> set[str]:
    """What instances of a class hold, with what it inherits from classes of its module, or of any other."""
    bases = (ast.unparse(base).split("[")[0].split(".")[-1] for base in kind.bases)
    found = (own.get(name) or known.get(name) for name in bases)
    return attributes(kind).union(*(all_attributes(one, own, known) for one in found if one and one is not kind))


def excused(kind: ast.ClassDef, lines: list[str]) -> bool:
    """Whether a comment says why a class has many attributes: within the class, or right above it."""
    first = min([kind.lineno, *(one.lineno for one in kind.decorator_list)])
    return any(EXCUSED_ATTRIBUTES.match(line) for line in lines[max(first - 2, 0) : kind.end_lineno])


Trees = dict[Path, ast.Module]


@pytest.fixture(scope="module")
def trees() -> Trees:
    """The library's files, parsed."""
    return {path: ast.parse(path.read_text(encoding="utf-8")) for path in LIBRARY.rglob("*.py")}


@pytest.mark.slow
def test_no_class_and_no_module_knows_too_much_without_saying_why(trees):
    paths = [path for room in ROOMS for path in room.rglob("*.py") if "tests" not in path.parts[-3:]]
    texts = {path: path.read_text(encoding="utf-8") for path in paths}
    trees = {path: trees.get(path) or ast.parse(text) for path, text in texts.items()}
    known = {name: kind for tree in reversed(trees.values()) for name, kind in classes_of(tree).items()}
    for path, tree in trees.items():
        assert len(imported(tree)) <= MOST or EXCUSED_MODULES.search(texts[path]), path
        own, lines = classes_of(tree), texts[path].splitlines()
        for name, kind in own.items():
            found = all_attributes(kind, own, known)
            assert len(found) <= MOST or excused(kind, lines), f"{path}: {name} has {len(found)}: {sorted(found)}"


def test_an_excuse_is_that_of_one_class_and_what_is_inherited_counts():
    text = "class A:\n    # More than 15 attributes: why\n    a: int\n    b: int\n\n\nclass B(A):\n    c: int\n"
    own = classes_of(ast.parse(text))
    assert all_attributes(own["B"], own, {}) == {"a", "b", "c"}
    assert [excused(kind, text.splitlines()) for kind in own.values()] == [True, False]


def doubled(names: Iterable[tuple[str, Path]]) -> dict[str, list[str]]:
    """Names that occur more than once, and where."""
    found: dict[str, list[str]] = {}
    for name, path in names:
        found.setdefault(name, []).append(str(path.relative_to(LIBRARY.parents[1])))
    return {name: paths for name, paths in found.items() if len(paths) > 1}


@pytest.mark.slow
def test_no_two_classes_of_the_library_have_the_same_name(trees):
    kinds = ((node.name, path) for path, tree in trees.items() for node in tree.body if isinstance(node, ast.ClassDef))
    assert not doubled(kinds)


def test_no_two_files_of_the_library_have_the_same_name():
    files = ((path.name, path) for path in LIBRARY.rglob("*.py") if path.name != "__init__.py")
    assert not doubled(files)


def test_no_two_kernel_files_of_the_library_have_the_same_name():
    files = ((path.name, path) for path in KERNELS.rglob("*.?pp"))
    assert not doubled(files)


TESTS = Path(__file__).parent


def test_no_two_files_of_tests_have_the_same_name():
    """pytest knows them by it, for they are in no packages: of two it collects none."""
    files = ((path.name, path) for room in (TESTS, TESTS.parent / "apps") for path in room.rglob("test_*.py"))
    assert not doubled(files)


NAMES = ("bridge", "cantilever", "couture", "furniture", "metallophone", "solid", "thermal", "vibration")
NAMED = "|".join(NAMES)
APPLICATION = re.compile(
    rf"restshape_apps\.|restshape_verification\.({NAMED})\b|\bapps/({NAMED})\b|\bapp\s*=\s*\\*[\"']({NAMED})\b"
    rf"|applications?\(\)?[\[(]?[\"']({NAMED})[\"']|\b(couture|furniture|metallophone|thermal)\b"
)
"""What names an application, of which some have the names of what mechanics speaks of."""
OF_ALL = {
    *("test_browser_drags.py", "test_browser_player.py", "test_examples.py", "test_house.py"),
    *("test_layers.py", "test_ranks_in_time.py", "test_recordings.py", "test_words.py"),
}
"""Tests of what goes over all applications."""


def test_tests_of_the_library_name_no_application():
    files = [path for path in TESTS.rglob("*") if path.suffix in (".py", ".toml", ".jsonl", ".txt")]
    assert len(files) > 200
    for path in files:
        if path.name not in OF_ALL:
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
                assert not APPLICATION.search(line), f"{path}:{number}: {line}"


def test_what_names_an_application_is_found():
    for line in ('app = "solid"', 'application("vibration")', "apps/bridge/scenes", "from restshape_apps.x import y"):
        assert APPLICATION.search(line)
    for line in ("[effects.solid]", 'settings("solid")', "a cantilever bends", "a vibration of the plate"):
        assert not APPLICATION.search(line)


def test_elements_are_symbols():
    """Elements are taken by their families' symbols, so that a wrong name is an ImportError."""
    found = [path for path in LIBRARY.rglob("*.py") if "_kernels.Element(" in path.read_text()]
    assert found == [], "take them from restshape.fem.elements"


CLASSES = ("analysis", "mesh", "fem", "shape")
CAPABILITIES = {"Differentiable", "Extreme", "RowOperation"}
"""What functions of a state, and operations, can do besides: it is asked of them."""


@pytest.mark.slow
def test_nothing_is_dispatched_on_classes_of_analyses_meshes_spaces_and_shapes(trees):
    """What differs between them is a method of theirs, or a member of a protocol."""
    kinds = {
        node.name
        for path, tree in trees.items()
        if path.relative_to(LIBRARY).parts[0] in CLASSES
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
    } - CAPABILITIES
    asked = [
        f"{path.relative_to(LIBRARY)}:{node.lineno}: {ast.unparse(node)}"
        for path, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and name_of(node.func) in ("isinstance", "issubclass")
        and kinds & {name.id for name in ast.walk(node.args[1]) if isinstance(name, ast.Name)}
    ]
    assert len(kinds) > 50 and asked == []


COUNTED = re.compile(r"\{len\([^{}]*\)(?: - 1)?\} (?:more )?[a-z]+s\b")
"""A number that may be one before a plural, in an f-string; `outputs.si_numbers.counted` knows both."""


def test_what_commands_count_may_be_one():
    for path in (path for room in ROOMS for path in room.rglob("*.py") if {"cli", "commands"} & {*path.parts[-3:-1]}):
        assert not COUNTED.findall(path.read_text(encoding="utf-8")), path
