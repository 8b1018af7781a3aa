"""Writes stubs: the types of extension modules, as pybind11 states them, and the names of the compiled elements.

python scripts/stubs.py            write them
python scripts/stubs.py --check    compare; exit code 1 where one differs from the module that is built

Each stub stands beside its module, without docstrings: those stand where the functions are bound, and in the modules.
"""

import argparse
import ast
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

ROOT = Path(__file__).parents[1]
MODULES = {
    "restshape._kernels": ROOT / "lib/restshape/_kernels.pyi",
    "restshape_apps.furniture._kernels": ROOT / "apps/furniture/_kernels.pyi",
}
ELEMENTS = ROOT / "lib/restshape/fem/elements.pyi"


def main() -> int:
    """Writes or compares all stubs; the exit code."""
    parser = argparse.ArgumentParser(description="Writes the stubs of the extension modules.")
    parser.add_argument("--check", action="store_true", help="compare them with the modules that are built")
    check, differ = parser.parse_args().check, False
    for path, write in stubs().items():
        found = write()
        if check and (not path.exists() or not same(found, path.read_text(encoding="utf-8"))):
            print(f"{path.relative_to(ROOT)} is not that of the module that is built: run python scripts/stubs.py")
            differ = True
        if not check:
            path.write_text(found, encoding="utf-8")
            subprocess.run([sys.executable, "-m", "ruff", "format", "--quiet", str(path)], check=True)
            print(f"wrote {path.relative_to(ROOT)}")
    return int(differ)


def stubs() -> Mapping[Path, Callable[[], str]]:
    """What writes the text of each stub."""
    return {path: partial(stub, module) for module, path in MODULES.items()} | {ELEMENTS: elements_stub}


def elements_stub() -> str:
    """The stub of `restshape.fem.elements`: a symbol for each family that is compiled, and no other."""
    from restshape.fem.elements import families

    lines = ["from restshape.fem.family import Family as Family", "", "def families() -> dict[str, Family]: ...", ""]
    return "\n".join([*lines, *(f"{symbol}: Family" for symbol in sorted(families())), ""])


def stub(module: str) -> str:
    """The stub of a module that is built, without docstrings."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pybind11_stubgen", module, "--exit-code", "--output-dir", folder]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"pybind11-stubgen cannot read {module}:\n{done.stderr}")
        path = Path(folder, *module.split(".")).with_suffix(".pyi")
        return ast.unparse(without_docstrings(ast.parse(path.read_text(encoding="utf-8")))) + "\n"


def without_docstrings(tree: ast.Module) -> ast.Module:
    """The same module without the docstrings of its classes and functions, in place."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Expr(ast.Constant(...))]
    return tree


def same(one: str, other: str) -> bool:
    """Whether two stubs say the same, however they are laid out."""
    return ast.dump(ast.parse(one)) == ast.dump(ast.parse(other))


if __name__ == "__main__":
    sys.exit(main())
