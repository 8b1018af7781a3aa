"""Imports go one way: between packages, between the parts of the library, and between its modules."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "restshape": ROOT / "lib" / "restshape",
    "restshape_apps": ROOT / "apps",
    "restshape_studies": ROOT / "studies",
    "restshape_verification": ROOT / "verification",
}
MAY_IMPORT = {
    "restshape": set(),
    "restshape_apps": {"restshape"},
    "restshape_studies": {"restshape"},
    "restshape_verification": {"restshape", "restshape_apps", "restshape_studies"},
}
"""What each package may import besides itself."""
LAYERS = (
    "_kernels",
    "bounds",
    "errors",
    "memory",
    "first_use",
    "outputs",
    "findings",
    "surroundings",
    "early_interrupts",
    "policy",
    "calibration",
    "arrays",
    "declared_paths",
    "application",
    "scene",
    "shape",
    "mesh",
    "algebra",
    "fem",
    "sensitivity",
    "measurement",
    "analysis",
    "guidance",
    "replay",
    "report",
    "export",
    "interface",
    "variation",
    "comparison",
    "live",
    "physics",
    "cli",
)
"""Parts of the library: each imports those before it alone."""
MADE = re.compile(r"(?<!class )\bReplay\(")
"""A frame loop that is made."""
HEAVY = {"numpy", "scipy", "pydantic", "rich", "h5py", "petsc4py", "matplotlib", "restshape._kernels"}


def module_name(package: str, path: Path) -> str:
    """The dotted name of a file of a package."""
    parts = path.relative_to(PACKAGES[package]).with_suffix("").parts
    return ".".join([package, *parts[: -1 if parts[-1] == "__init__" else None]])


MODULES = {
    module_name(package, path): path
    for package, folder in PACKAGES.items()
    for path in folder.rglob("*.py")
    if "tests" not in path.parts[len(ROOT.parts) :]
}


STATEMENTS = (ast.stmt, ast.excepthandler, ast.match_case)
"""What may hold an import."""


def imported(tree: ast.Module, annotations: bool) -> Iterator[str]:
    """Modules of ours that a file imports, anywhere in it.

    Args:
        annotations: those that only annotations need, too.
    """
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING" and not annotations:
            waiting += node.orelse
            continue
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from (name if name in MODULES or name == "restshape._kernels" else node.module for name in names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        waiting += (inner for inner in ast.iter_child_nodes(node) if isinstance(inner, STATEMENTS))


@cache
def read(path: Path) -> tuple[frozenset[str], frozenset[str]]:
    """Modules of our packages that a file imports: without those that only annotations need, and with them."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    without, with_them = (
        frozenset(name for name in imported(tree, annotations) if name.partition(".")[0] in PACKAGES)
        for annotations in (False, True)
    )
    return without, with_them


def ours(path: Path, annotations: bool = False) -> frozenset[str]:
    """Modules of our packages that a file imports."""
    return read(path)[annotations]


def layer(name: str) -> str:
    """The part of the library that a module is in; empty for what its root says of all."""
    return [*name.split("."), ""][1]


@pytest.mark.slow
@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_one_way(package):
    allowed = MAY_IMPORT[package] | {package}
    wrong = [
        f"{module} imports {name}"
        for module, path in MODULES.items()
        if module.partition(".")[0] == package
        for name in ours(path, annotations=True)
        if name.partition(".")[0] not in allowed
    ]
    assert wrong == []


def test_an_application_imports_no_other_one():
    wrong = [
        f"{module} imports {name}"
        for module, path in MODULES.items()
        if module.startswith("restshape_apps.")
        for name in ours(path)
        if name.startswith("restshape_apps.") and name.split(".")[1] != module.split(".")[1]
    ]
    assert wrong == []


def test_parts_of_the_library_are_in_order():
    parts = {layer(module) for module in MODULES if module.startswith("restshape.")}
    assert parts <= set(LAYERS)
    wrong = [
        f"{module} imports {name}"
        for module, path in MODULES.items()
        if module.startswith("restshape.")
        for name in ours(path)
        if layer(name) and layer(name) != layer(module) and LAYERS.index(layer(name)) >= LAYERS.index(layer(module))
    ]
    assert wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("annotations", [False, True])
def test_no_modules_import_each_other(annotations):
    graph = {module: ours(path, annotations) & set(MODULES) - {module} for module, path in MODULES.items()}
    circle: list[str] = []
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        circle = error.args[1]
    assert circle == []


def test_the_frame_loop_is_made_in_one_place():
    scripts = {f"scripts.{path.stem}": path for path in (ROOT / "scripts").glob("*.py")}
    made = {name for name, path in {**MODULES, **scripts}.items() if MADE.search(path.read_text(encoding="utf-8"))}
    assert made == {"restshape.interface.frame_loop"}


@pytest.mark.cli
def test_help_imports_nothing_heavy():
    program = "import sys; from restshape.cli.main import main; sys.argv[1:] = ['--help']\ntry: main()\nfinally: "
    program += f"print('heavy:', sorted({HEAVY!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "heavy: []", done.stdout + done.stderr
