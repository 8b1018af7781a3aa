"""Stamps of committed results: of which code and commit each file is. docs/results.md explains them.

A stamp is a line such as `commit 0123456789ab, code 0123456789abcdef, content 0123456789abcdef`, kept in the file
itself: in the metadata of PNG and WAV, as the key "stamp" of JSON, as a comment that ends Markdown or GIF.
"""

from __future__ import annotations

import ast
import hashlib
import json
import re
import struct
import tomllib
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {
    "restshape": "lib/restshape",
    "restshape_apps": "apps",
    "restshape_studies": "studies",
    "restshape_verification": "verification",
    "tests": "tests",
}
"""Packages, and their folders; tests have no package, but one of them draws a picture."""
KERNELS = {"restshape._kernels": "lib/kernels", "restshape_apps.furniture._kernels": "apps/furniture/kernels"}
"""Extension modules, and the folder of their sources."""
REFERENCE = re.compile(r"restshape\w*(\.\w+)+(?=:\w+$)")
"""The module in a text `module:attribute`, which is imported when asked for."""
TEXTS = (b"tEXt", b"zTXt", b"iTXt", b"tIME")
PNG, CHUNK = b"\x89PNG\r\n\x1a\n", b"tEXtStamp\0"
SOUND_STAMP = re.compile(rb"LIST.{4}INFOICMT(.{4})", re.S)
"""The head of the chunk of a WAV file that holds its stamp, with the length of the text."""
GIF_COMMENT, GIF_END = b"\x21\xfe", b"\x00;"
"""What a comment of a GIF begins with, and the end of its last one and of the file."""


@dataclass(frozen=True)
class Stamp:
    """What a result is of.

    Args:
        commit: short hash of the commit that it was made on; "+" at the end: with changes that were not committed.
        code: hash of all that it depends on.
        content: hash of the file without its stamp.
        accepted: why a change of the code is known not to change it; empty where it was made by this code.
        timed: where and beside what its times were taken, such as "on core 1 of 2 at load 0.3"; empty without times.
    """

    commit: str
    code: str
    content: str
    accepted: str = ""
    timed: str = ""

    def __str__(self) -> str:
        ending = f", timed {self.timed}" * bool(self.timed) + f", accepted: {self.accepted}" * bool(self.accepted)
        return f"commit {self.commit}, code {self.code}, content {self.content}{ending}"

    @classmethod
    def of(cls, text: str) -> Stamp | None:
        """The stamp that a line has; None where it has none."""
        form = r"commit (\S+), code (\w+), content (\w+)(?:, timed ([^,]+))?(?:, accepted: (.+))?"
        found = re.fullmatch(form, text.strip())
        return cls(found[1], found[2], found[3], found[5] or "", found[4] or "") if found else None


def digest(parts: Iterable[str | bytes]) -> str:
    """A hash of texts, in their order."""
    found = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        found.update(len(data).to_bytes(8, "little") + data)
    return found.hexdigest()[:16]


# --- code ---------------------------------------------------------------------------------------------------------


@cache
def module_path(module: str, root: Path) -> Path | None:
    """The file of a module of the project; None of any other."""
    package, _, rest = module.partition(".")
    if package not in PACKAGES or not rest:
        return None
    path = root / PACKAGES[package] / rest.replace(".", "/")
    return next((p for p in (path.with_suffix(".py"), path / "__init__.py") if p.is_file()), None)


def expanded(entry: str) -> list[str]:
    """A module, or all modules of a package that is written with `.*`."""
    package, star, _ = entry.partition(".*")
    first, _, rest = package.partition(".")
    folder = ROOT / PACKAGES.get(first, first) / rest.replace(".", "/")
    return [f"{package}.{path.stem}" for path in sorted(folder.glob("*.py"))] if star else [entry]


@cache
def parsed(path: Path) -> tuple[str, frozenset[str]]:
    """A source without comments, docstrings and layout, and the names of modules that it imports or refers to."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names |= {found[0] for found in [REFERENCE.match(node.value)] if found}
        body = getattr(node, "body", None)
        if isinstance(body, list):
            # A docstring, or a text below a constant, says what code does and does nothing.
            node.body = [one for one in body if not _is_text(one)] or [ast.Pass()]
    return ast.dump(tree), frozenset(names)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def closure(entries: Iterable[str]) -> dict[str, Path | None]:
    """All modules of the project that some modules import, at any place, by name; None: an extension module."""
    found: dict[str, Path | None] = {}
    waiting = [module for entry in entries for module in expanded(entry)]
    while waiting:
        module = waiting.pop()
        path = None if module in found else module_path(module, ROOT)
        if module in found or (path is None and module not in KERNELS):
            continue
        found[module] = path
        if path:
            waiting += parsed(path)[1]
    return found


def plain(path: Path) -> str:
    """What a file of data or kernels says, without comments and layout where its format separates them."""
    text = path.read_text(encoding="utf-8", errors="replace")
    match path.suffix:
        case ".json" if read_stamp(path):
            return split(path)[0].decode()
        case ".toml":
            return json.dumps(tomllib.loads(text), sort_keys=True, default=str)
        case ".cpp" | ".hpp":
            code = re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.DOTALL)
            return " ".join(code.split())
    return text


def code_hash(entries: Iterable[str], data: Iterable[Path]) -> str:
    """The hash of all that a result depends on: modules, kernels, tables of the library, scenes and scripts.

    Args:
        entries: modules whose imports are followed.
        data: files that are read.
    """
    modules = closure(entries)
    parts = [f"{name}\n{parsed(path)[0]}" for name, path in sorted(modules.items()) if path]
    files = set(data)
    for name, path in modules.items():
        folder = ROOT / KERNELS[name] if name in KERNELS else path.parent if path else ROOT
        kinds = ("*.cpp", "*.hpp") if name in KERNELS else ("*.toml", "*.json")
        files |= {one for kind in kinds for one in (folder.rglob(kind) if name in KERNELS else folder.glob(kind))}
    return digest([*parts, *(f"{path.relative_to(ROOT)}\n{plain(path)}" for path in sorted(files))])


# --- files --------------------------------------------------------------------------------------------------------


def chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Kind and whole bytes of each chunk of a PNG."""
    place = len(PNG)
    while place < len(data):
        end = place + 12 + struct.unpack(">I", data[place : place + 4])[0]
        yield data[place + 4 : place + 8], data[place:end]
        place = end


def split(path: Path) -> tuple[bytes, str]:
    """A file without its stamp, and the text of the stamp; empty where there is none.

    Raises:
        ValueError: its format holds no stamp.
    """
    data = path.read_bytes()
    match path.suffix:
        case ".png":
            own = [whole for _, whole in chunks(data) if whole[4:].startswith(CHUNK)]
            rest = PNG + b"".join(whole for _, whole in chunks(data) if whole not in own)
            return rest, own[0][4 + len(CHUNK) : -4].decode("latin-1") if own else ""
        case ".wav":
            found = SOUND_STAMP.search(data)
            if not found:
                return data, ""
            end = found.end() + struct.unpack("<I", found[1])[0]
            return _sized(data[: found.start()] + data[end:]), data[found.end() : end].rstrip(b"\0").decode("latin-1")
        case ".gif":
            place = data.rfind(GIF_COMMENT)
            text = _unblocked(data[place + 2 : -2]) if place >= 0 else ""
            return (data[:place] + data[-1:], text) if Stamp.of(text) else (data, "")
        case ".md":
            found = re.search(r"\n<!-- stamp: (.*) -->\n\Z", data.decode())
            return (data[: len(data) - len(found[0].encode())], found[1]) if found else (data, "")
        case ".json":
            found = json.loads(data)
            stamp = found.pop("stamp", "") if isinstance(found, dict) else ""
            found = found["rows"] if stamp and set(found) == {"rows"} else found
            return json.dumps(found, indent=1).encode() + b"\n", stamp
    raise ValueError(f"{path}: a result is .png, .gif, .wav, .md or .json")


def _blocked(text: bytes) -> bytes:
    """A text in the blocks of GIF: each at most 255 bytes behind its length."""
    return b"".join(bytes([len(part)]) + part for part in (text[k : k + 255] for k in range(0, len(text), 255)))


def _unblocked(data: bytes) -> str:
    """The text of blocks of GIF."""
    text = b""
    while data:
        text, data = text + data[1 : 1 + data[0]], data[1 + data[0] :]
    return text.decode("latin-1")


def _sized(sound: bytes) -> bytes:
    """A WAV file whose head knows how long it is."""
    return sound[:4] + struct.pack("<I", len(sound) - 8) + sound[8:]


def content_hash(path: Path) -> str:
    """The hash of a file without its stamp; of a picture without any text that describes it."""
    rest, _ = split(path)
    if path.suffix != ".png":
        return digest([rest])
    return digest(whole for kind, whole in chunks(rest) if kind not in TEXTS)


def write_stamp(path: Path, stamp: Stamp) -> None:
    """Put a stamp into a file, in place of the one that it has."""
    rest, _ = split(path)
    text = str(stamp).encode("latin-1", errors="replace")
    match path.suffix:
        case ".png":
            body = CHUNK + text
            own = struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
            # Behind the first chunk, so that readers have it before the pixels.
            first = PNG + next(whole for _, whole in chunks(rest))
            rest = first + own + rest.removeprefix(first)
        case ".wav":
            text += b"\0" * (len(text) % 2)
            own = b"INFOICMT" + struct.pack("<I", len(text)) + text
            # Before the chunk at the end by which the program knows its own sounds.
            sound, mark, program = rest.partition(b"LIST")
            rest = _sized(sound + b"LIST" + struct.pack("<I", len(own)) + own + mark + program)
        case ".gif":
            rest = rest[:-1] + GIF_COMMENT + _blocked(text) + GIF_END
        case ".md":
            rest += f"\n<!-- stamp: {stamp} -->\n".encode()
        case ".json":
            found = json.loads(rest)
            table = found if isinstance(found, dict) else {"rows": found}
            rest = json.dumps({"stamp": str(stamp), **table}, indent=1).encode() + b"\n"
    path.write_bytes(rest)


def read_stamp(path: Path) -> Stamp | None:
    """The stamp of a file; None where it has none, or one that cannot be read."""
    return Stamp.of(split(path)[1])
