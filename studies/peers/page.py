"""The page of `restshape bench peers`: where restshape loses first, then each case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from restshape.outputs.atomic_files import write_whole

START = "start"
"""The case of processes from their start to the first answer."""
Found = Mapping[str, Any]
MEASURES = {
    "processor_ms": ("a frame, processor", "ms"),
    "processor": ("start to first answer, processor", "s"),
    "peak_mb": ("peak memory", "MB"),
}
"""What is compared, and its unit."""


class Loss(NamedTuple):
    """Something that takes restshape more than a peer.

    Args:
        times: restshape's over the peer's.
        case, peer, what: of which; own, other: both numbers with their unit.
    """

    times: float
    case: str
    peer: str
    what: str
    own: str
    other: str


def entries(name: str, found: Found) -> Iterator[tuple[str, Found]]:
    """Each peer that has numbers in a case, with its way."""
    if name == START:
        yield from ((peer, one) for peer, one in found.items() if peer != "restshape" and "processor" in one)
        return
    for peer, ways in found["peers"].items():
        yield from ((f"{peer}, {way}", one) for way, one in ways.items() if "ratio" in one)


def losses(found: Found) -> list[Loss]:
    """Where a peer takes less than restshape, the largest loss first."""
    rows = []
    for name, case in found.items():
        own = case["restshape"]
        for peer, other in entries(name, case):
            for key, (what, unit) in MEASURES.items():
                if key in own and other.get(key) and own[key] > other[key]:
                    numbers = (f"{own[key]:.3g} {unit}", f"{other[key]:.3g} {unit}")
                    rows.append(Loss(own[key] / other[key], name, peer, what, *numbers))
    return sorted(rows, reverse=True)


def table(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table in Markdown."""
    lines = [heads, ("---",) * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def case_rows(case: Found) -> list[tuple[str, ...]]:
    """A row for restshape and each peer: what a table of a case holds."""
    own = case["restshape"]
    rows = [("restshape", *_times(own), "1", "")]
    for peer, ways in case["peers"].items():
        for way, one in ways.items():
            if "ratio" in one:
                rows.append((f"{peer}, {way}", *_times(one), f"{one['ratio']:.3g}", f"{one['distance']:.1e}"))
            else:
                rows.append((f"{peer}, {way}", one.get("cannot") or one["failed"], "", "", "", "", ""))
    return rows


CASE_HEADS = (
    "program",
    "frame, processor [ms]",
    "clock [ms]",
    "first frame [ms]",
    "peak [MB]",
    "times restshape's",
    "answers apart",
)


def _times(one: Found) -> tuple[str, ...]:
    clock = "-" if one["ms"] is None else f"{one['ms']:.3g}"
    return f"{one['processor_ms']:.3g}", clock, f"{one['first_ms']:.3g}", f"{one['peak_mb']:.0f}"


START_HEADS = ("program", "clock [s]", "processor [s]", "peak [MB]")


def start_rows(case: Found) -> list[tuple[str, ...]]:
    """A row for each program."""
    return [
        (name, f"{one['seconds']:.2f}", f"{one['processor']:.2f}", f"{one['peak_mb']:.0f}")
        if "seconds" in one
        else (name, one["failed"], "", "")
        for name, one in case.items()
    ]


def versions(found: Found) -> list[str]:
    """Versions of all programs."""
    names = {f"restshape {case['restshape']['version']}" for name, case in found.items() if name != START}
    for name, case in found.items():
        if name != START:
            names |= {one["version"] for ways in case["peers"].values() for one in ways.values() if "version" in one}
    return sorted(names, key=str.lower)


INTRODUCTION = """\
The same edits through other solvers. Each program has one core and one thread. Peers are handed restshape's mesh of
each frame as arrays. Each is there as its documentation would have it, and as an expert would tune it; the programs are
in `studies/peers/`. A peer's answers are compared with restshape's before its time counts: `answers apart` is the
largest distance of a frame, relative, in the norm of all nodes or modes. Times are medians over frames, of the
processor and of the clock; ratios are of the processor, as other work on the machine disturbs these the least.
Restshape's frames hold edit, motion of the mesh or mesher, solution and quantities, those of peers the solution alone.
"""


def page(found: Found, command: str) -> str:
    """The page in Markdown."""
    cases = {name: case for name, case in found.items() if name != START}
    machine = next((case["machine"] for case in cases.values()), "")
    parts = [
        "# Restshape beside other solvers\n",
        f"```sh\n{command}\n```\n",
        f"{', '.join(versions(found))}; {machine}, one core.\n",
        INTRODUCTION,
        "## Where restshape loses\n",
    ]
    lost = [(one.case, one.what, one.peer, one.own, one.other, f"{one.times:.2f}") for one in losses(found)]
    heads = ("case", "what", "peer", "restshape", "peer's", "restshape's over the peer's")
    parts.append(table(heads, lost) if lost else "Nowhere among these cases.\n")
    if START in found:
        parts += [
            "## From the start of the process to the first answer\n",
            START_WORDS,
            table(START_HEADS, start_rows(found[START])),
        ]
    for name, case in cases.items():
        parts += [f"## {name}: {case['title']}\n", _words(name, case), table(CASE_HEADS, case_rows(case))]
    return "\n".join(parts)


START_WORDS = """\
`restshape bench peers --cases start`. Peers begin with the mesh as arrays, restshape with the scene, and it makes the
mesh.
"""


def _words(name: str, case: Found) -> str:
    own = case["restshape"]
    note = f"{case['note'][:1].upper()}{case['note'][1:]}. " if case["note"] else ""
    frames = "1 frame" if own["frames"] == 1 else f"{own['frames']} frames"
    sizes = f"{own['elements']:,} triangles, {own['unknowns']:,} unknowns of restshape's, {frames}"
    return f"`restshape bench peers --cases {name}`. {note}{sizes}.\n"


def write_page(found: Found, path: Path, command: str) -> None:
    """Writes the page."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, page(found, command))
