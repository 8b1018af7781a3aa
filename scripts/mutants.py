"""Plants faults in a copy of the checkout, one after the other, and looks whether the test that each names notices it.

python scripts/mutants.py                  all of them; writes results/mutants.md
python scripts/mutants.py heat-source ...  those alone, or those of a file such as kernels; the other rows stay
python scripts/mutants.py --check          writes nothing
python scripts/mutants.py --list           names, files and tests

A mutant is a fault: one exact text of one file, what takes its place, and the test that must fail with it. They are in
scripts/mutants/*.toml. Tests run in the copy, first without any fault, where all must pass. Of the compiled modules
only what depends on the changed file is compiled. The exit code is 1 where a test does not notice its fault, and 2
where a mutant is outdated: its text is not in its file once, or its test is not there, or fails without it.
"""

import argparse
import ast
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import cache_from_source
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "scripts" / "mutants"
TABLE = ROOT / "results" / "mutants.md"
PACKAGES = {
    "restshape": "lib/restshape",
    "restshape_apps": "apps",
    "restshape_studies": "studies",
    "restshape_verification": "verification",
}
LIMIT = 600.0
"""Seconds that a test may take: one that a fault keeps from ending has noticed it."""
CAUGHT, MISSED, OUTDATED = "caught", "MISSED", "outdated"
WRITTEN = {"with": "replacement"}
"""Names of fields in the files, where they are others."""
COMPILED = (".cpp", ".hpp")
FAILED = 1
"""Exit code of pytest where tests fail; others are of tests that are not there or cannot be read."""


@dataclass(frozen=True)
class Mutant:
    """A fault that is planted.

    Args:
        group: name of the file that lists it.
        name: of the mutant.
        fault: what is wrong, in words.
        file: in which it is, from the root of the checkout.
        text: of the file, there once; replacement: what takes its place.
        test: that must fail, as ``path::name``.
    """

    group: str
    name: str
    fault: str
    file: str
    text: str
    replacement: str
    test: str

    def problem(self, root: Path) -> str:
        """Why it cannot be planted in a checkout; empty where it can."""
        path = root / self.file
        times = path.read_text(encoding="utf-8").count(self.text) if path.is_file() else -1
        if times != 1:
            return f"{self.file} is not there" if times < 0 else f"{self.file} has its text {times} times, not once"
        if self.text == self.replacement:
            return "it changes nothing"
        return test_problem(root, self.test)


def test_problem(root: Path, test: str) -> str:
    """Why a test ``path::name``, with its parameters in brackets or without, or ``path::class::name`` is not there."""
    path, *names = test.split("::")
    if not (root / path).is_file():
        return f"{path} is not there"
    scope = ast.parse((root / path).read_text(encoding="utf-8")).body
    if not names:
        return "no test is named"
    for name in names:
        found = next((node for node in scope if getattr(node, "name", "") == name.partition("[")[0]), None)
        if found is None:
            return f"{path} has no test {'::'.join(names)}"
        scope = found.body
    return ""


def mutants() -> list[Mutant]:
    """All mutants, by file and in its order."""
    return [
        Mutant(path.stem, **{WRITTEN.get(key, key): value for key, value in one.items()})
        for path in sorted(FOLDER.glob("*.toml"))
        for one in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    ]


def copy_checkout(folder: Path) -> None:
    """Copy what git knows, as it lies, and what has been built, with the times of all files."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    built = [path.relative_to(ROOT) for room in ("lib", "apps") for path in (ROOT / room).rglob("_kernels.*.so")]
    for name in [*filter(None, listed.split("\0")), *built]:
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    if (ROOT / "build" / "kernels").is_dir():
        shutil.copytree(ROOT / "build" / "kernels", folder / "build" / "kernels")
    (folder / "paths").mkdir()
    for package, place in PACKAGES.items():
        (folder / "paths" / package).symlink_to(folder / place)


def surroundings(folder: Path) -> dict[str, str]:
    """The environment of a process that takes the packages of the copy."""
    return os.environ | {"PYTHONPATH": str(folder / "paths"), "OMP_NUM_THREADS": "1"}


def run_tests(folder: Path, tests: list[str]) -> int | None:
    """The exit code of pytest with tests of the copy; None where they do not end."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    try:
        return subprocess.run(
            command, cwd=folder, env=surroundings(folder), timeout=LIMIT, capture_output=True
        ).returncode
    except subprocess.TimeoutExpired:
        return None


def compile_kernels(folder: Path) -> str:
    """Compile what is stale in the copy; the compiler's last words where it refuses, else nothing."""
    command = [sys.executable, "setup.py", "-q", "build_ext", "--inplace"]
    done = subprocess.run(command, cwd=folder, env=surroundings(folder), capture_output=True, text=True)
    return "" if done.returncode == 0 else (done.stdout + done.stderr).strip()[-300:]


@contextmanager
def planted(mutant: Mutant, folder: Path) -> Iterator[None]:
    """The copy with a fault; afterwards all is as before, times of files too, so that nothing is compiled twice."""
    path = folder / mutant.file
    touched = [path]
    if path.suffix in COMPILED:
        touched += [note.with_suffix(".o") for note in (folder / "build").rglob("*.d") if mutant.file in words_of(note)]
        touched += [*folder.glob("lib/restshape/_kernels.*.so"), *folder.glob("apps/*/_kernels.*.so")]
    with tempfile.TemporaryDirectory(prefix="restshape-kept-") as name:
        kept = [(one, Path(name) / str(number)) for number, one in enumerate(touched)]
        for one, place in kept:
            shutil.copy2(one, place)
        path.write_text(path.read_text(encoding="utf-8").replace(mutant.text, mutant.replacement), encoding="utf-8")
        # Python takes a compiled file for that of any source of the same size and second.
        compiled = Path(cache_from_source(path))
        compiled.unlink(missing_ok=True)
        try:
            yield
        finally:
            compiled.unlink(missing_ok=True)
            for one, place in kept:
                shutil.copy2(place, one)


def words_of(note: Path) -> set[str]:
    """The files that the compiler has noted in a file of dependencies."""
    return set(note.read_text(encoding="utf-8").split())


def outcome(mutant: Mutant, folder: Path) -> tuple[str, str]:
    """Whether the mutant's test notices it, and a word on how."""
    problem = mutant.problem(folder)
    if problem:
        return OUTDATED, problem
    with planted(mutant, folder):
        if Path(mutant.file).suffix in COMPILED and (refused := compile_kernels(folder)):
            return OUTDATED, f"it does not compile: {refused}"
        code = run_tests(folder, [mutant.test])
    if code == 0:
        return MISSED, ""
    if code is None or code < 0:
        return CAUGHT, "does not end" if code is None else f"ends by signal {-code}"
    return (CAUGHT, "") if code == FAILED else (OUTDATED, f"pytest ends with {code}")


def chosen(names: list[str]) -> list[Mutant]:
    """The mutants of these names or groups; all where there is none."""
    known = mutants()
    unknown = [name for name in names if name not in {word for one in known for word in (one.name, one.group)}]
    if unknown:
        raise SystemExit(f"no mutant and no group is named {unknown[0]}: see --list")
    return [one for one in known if not names or one.name in names or one.group in names]


def play(wanted: list[Mutant]) -> dict[str, str]:
    """The outcome of each mutant by its name, with a remark in parentheses; printed as it comes."""
    found: dict[str, str] = {}
    with tempfile.TemporaryDirectory(prefix="restshape-mutants-") as name:
        folder = Path(name)
        copy_checkout(folder)
        refused = compile_kernels(folder)
        if refused:
            raise SystemExit(f"the copy does not compile: {refused}")
        passed = run_tests(folder, sorted({one.test for one in wanted if not one.problem(folder)}))
        if passed != 0:
            raise SystemExit("the tests fail without any fault, or cannot be run: see pytest in the checkout itself")
        for one in wanted:
            what, remark = outcome(one, folder)
            found[one.name] = f"{what} ({remark})" if remark else what
            print(f"{one.group}.{one.name}  {one.test}  {found[one.name]}", flush=True)
    return found


def written() -> dict[str, str]:
    """The outcomes in results/mutants.md, by the fault."""
    lines = TABLE.read_text(encoding="utf-8").splitlines() if TABLE.is_file() else []
    cells = [line.strip("| ").split(" | ") for line in lines if line.startswith("| ")]
    return {row[0]: row[-1] for row in cells}


def table(outcomes: dict[str, str]) -> str:
    """The page of results/mutants.md; of mutants without an outcome by their name it says what it said."""
    before = written()
    rows = [(one, outcomes.get(one.name) or before.get(one.fault, "not run")) for one in mutants()]
    caught = sum(found.startswith(CAUGHT) for _, found in rows)
    lines = [
        "# Planted faults",
        "",
        "Written by `scripts/mutants.py`: each fault was planted by itself, and the test that it names was run.",
        f"Of {len(rows)} faults {caught} were caught.",
    ]
    for group in dict.fromkeys(one.group for one, _ in rows):
        lines += ["", f"## {group.capitalize()}", "", "| fault | file | test | outcome |", "| --- | --- | --- | --- |"]
        for one, found in rows:
            if one.group == group:
                path, _, test = one.test.partition("::")
                words = f"`{Path(path).name}`: `{test.replace('::', ' ')}`"
                lines.append(f"| {one.fault} | `{one.file}` | {words} | {found} |")
    return "\n".join([*lines, ""])


def main() -> int:
    """Plant the faults; the exit code."""
    parser = argparse.ArgumentParser(description="Plants faults in a copy, and looks whether tests notice them.")
    parser.add_argument("names", nargs="*", help="mutants or groups; default: all")
    parser.add_argument("--check", action="store_true", help="write no table")
    parser.add_argument("--list", action="store_true", help="names, files and tests, and no run")
    args = parser.parse_args()
    wanted = chosen(args.names)
    if args.list:
        print("\n".join(f"{one.group}.{one.name}  {one.file}  {one.test}" for one in wanted))
        return 0
    found = play(wanted)
    if not args.check:
        TABLE.write_text(table(found), encoding="utf-8")
    counts = {kind: sum(word.startswith(kind) for word in found.values()) for kind in (CAUGHT, MISSED, OUTDATED)}
    print(", ".join(f"{count} {kind}" for kind, count in counts.items()))
    return 1 if counts[MISSED] else 2 if counts[OUTDATED] else 0


if __name__ == "__main__":
    raise SystemExit(main())
