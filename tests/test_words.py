"""Words that the field has others for do not come back, in names and in what people read."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("lib/restshape", "apps", "studies", "verification", "tests", "scripts")
RETIRED = {
    "anew": "again, rebuilt",
    "at_rest": "converged, static",
    "broken": "overloaded, violated",
    "carried": "projected, advected",
    "deepest": "max_penetration",
    "foretold": "predicted",
    "foresight": "predictor",
    "held": "constrained, grabbed",
    "imbalance": "residual",
    "laid": "placed",
    "pierced": "tunnelling",
    "piercing": "tunnelling",
    "reseat": "re-interpolate",
    "sound": "valid",
    "spoilt": "low quality",
    "tell": "print, report",
    "tells": "reports, shows",
    "told": "reported",
    "unheld": "unconstrained",
    "verdict": "constraint status",
}
"""Words that are retired, by what is written today."""
ALLOWED = {
    ("apps/furniture/session/plank_session.py", "carried"): "carried out",
    ("apps/metallophone", "sound"): "what is heard",
    ("lib/restshape/outputs/kinds.py", "sound"): "a WAV file",
    ("lib/restshape/live/frame_header.py", "held"): "what the hand has, in messages of the page",
    ("lib/restshape/physics/elasticity/inspection.py", "sound"): "its speed",
    ("lib/restshape/cli/console.py", "broken"): "a broken pipe",
    ("lib/restshape/mesh/generate.py", "broken"): "a mesh file",
    ("lib/restshape/shape", "carried"): "carried out",
    ("studies/stability", "broken"): "a process that broke off",
    ("lib/restshape/replay/columns.py", "verdict"): "the name that version 0.1 gave the column",
    ("lib/restshape/replay/columns.py", "at_rest"): "the name that version 0.1 gave the column",
    ("lib/restshape/replay/columns.py", "broken"): "the name that version 0.1 gave the column",
    ("lib/restshape/replay/columns.py", "deepest"): "the name that version 0.1 gave the column",
    ("lib/restshape/replay/recording/good_frames.py", "tell"): "a method of files",
    ("lib/restshape/replay/recording/journal.py", "tell"): "a method of files",
    ("scripts/stamps.py", "sound"): "a WAV file",
    ("tests", "held"): "compared, constrained, kept",
    ("apps/furniture/tests", "held"): "grabbed",
    ("tests/cli/test_outputs.py", "sound"): "a WAV file",
    ("tests/physics/test_pitch.py", "sound"): "what is heard",
    ("tests/replay/test_old_names.py", "verdict"): "the name that version 0.1 gave the column",
    ("tests/replay/test_recorder.py", "broken"): "a broken pipe",
    ("tests/test_stamps.py", "sound"): "a WAV file",
}
"""Plain uses, by path and word, and what they mean there."""
PHRASES = re.compile(r"\b(tells?|told|forces out of balance|at rest under|least use|largest use)\b")
"""Of texts that people read at the console: other uses of retired words are plain English there."""


PARTED = [
    re.compile(f"""{one}["'fr]*{other}""") for one, other in (("at", "rest"), ("least", "use"), ("largest", "use"))
]
"""Words of phrases, which may stand in two strings."""


def suspected(text: str) -> bool:
    """Whether a file may have a hit: only these few need be parsed, which takes most of the time."""
    text = "".join(text.lower().replace("_", "").split())
    words = (*(word.replace("_", "") for word in RETIRED), "balance")
    return any(word in text for word in words) or any(parted.search(text) for parted in PARTED)


def sources() -> Iterator[Path]:
    """The files of the program, its tests and its scripts; this one alone may name retired words."""
    for room in ROOMS:
        yield from (path for path in sorted((ROOT / room).rglob("*.py")) if path != Path(__file__))


def names(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """What a file gives names to, with the line: functions, classes, arguments, variables and attributes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            yield node.name, node.lineno
        elif isinstance(node, ast.arg):
            yield node.arg, node.lineno
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id, node.lineno
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr, node.lineno


def texts(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Strings that are no docstrings, with the line: messages, summaries, keys and titles."""
    plain = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in plain:
            yield node.value, node.lineno


def parts(name: str) -> set[str]:
    """The words of a name, and the name itself without leading underscores, in small letters."""
    whole = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().strip("_")
    return {whole, *whole.split("_")}


GONE = re.compile(r"\b(anew|foretold|spoilt|unheld|verdicts?)\b")
"""Of any text, comments and docstrings too."""


def allowed(where: str, word: str) -> bool:
    return any(where.startswith(path) and word == one for path, one in ALLOWED)


def retired(where: str, text: str) -> list[str]:
    """Each retired word in names and strings of a file, with its place and what to write."""
    if not suspected(text):
        return []
    tree, found = ast.parse(text), []
    for name, line in names(tree):
        hits = (word for word in parts(name) & RETIRED.keys() if not allowed(where, word))
        found += [f"{where}:{line}: {name}: write {RETIRED[word]}" for word in hits]
    for value, line in texts(tree):
        hits = (word for word in PHRASES.findall(value) if not allowed(where, word))
        found += [f"{where}:{line}: {word!r} in {value[:60]!r}" for word in hits]
    for line, said in enumerate(text.splitlines(), 1):
        hits = (word for word in GONE.findall(said) if not allowed(where, word))
        found += [f"{where}:{line}: {word!r}: write {RETIRED[word.removesuffix('s')]}" for word in hits]
    return found


@pytest.mark.slow
def test_no_retired_word_is_a_name_or_in_a_message():
    found = [
        one for path in sources() for one in retired(str(path.relative_to(ROOT)), path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n".join(found)


def test_what_is_allowed_is_there():
    """No exception outlives its use."""
    for path, word in ALLOWED:
        files = [ROOT / path] if path.endswith(".py") else list((ROOT / path).rglob("*.py"))
        assert not files or any(word in one.read_text(encoding="utf-8") for one in files), (path, word)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("def sound(rows): pass", 1),
        ("class Verdict: pass", 1),
        ("AT_REST = 1", 1),
        ("x.deepest = 1", 1),
        ("def f(told): pass", 1),
        ("raise E('nothing tells how far')", 1),
        ('f"the verdict is {x}"', 1),
        ('x = (f"{n} forces out "\n    f"of balance")', 1),
        ("x = 'the least' f' use of {n}'", 1),
        ('def f():\n    """A docstring tells."""', 0),
        ("x = 'a sound body'", 0),
        ("converged = rebuilt = 1", 0),
    ],
)
def test_retired_words_are_found(text, count):
    assert len(retired("lib/restshape/x.py", text)) == count


PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
OLD_NAMES = {"recording-format.md", "scene-format.md"}
"""Pages that list what version 0.1 called columns and keys."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_are_free_of_them(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    found = [line for line in lines if re.search(r"\b(tells?|told|anew|foretold|verdicts?)\b", line)]
    assert page.name in OLD_NAMES or not found
