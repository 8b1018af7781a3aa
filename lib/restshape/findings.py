"""Findings: what is wrong with a design, as data. They are formatted where they are shown."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

FINDINGS_BYTES = 1200
"""Of the column `findings` at most."""
RESERVED = 64
"""Bytes for how many findings of a kind are omitted."""
OMITTED = "omitted"
"""Detail of a finding whose value counts others of its kind, for which there was no room."""


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong.

    Args:
        kind: of the flaw, such as "limit".
        detail: which flaw of that kind.
        subjects: names of what it is about, such as quantities.
        value: what was found, in `unit`; a count where there is no bound.
        bound: what the value is beyond, or is compared with.
        unit: SI.
        case: load case; empty where it is of none.
    """

    kind: str
    detail: str = ""
    subjects: tuple[str, ...] = ()
    value: float | None = None
    bound: float | None = None
    unit: str = ""
    case: str = ""

    @property
    def identity(self) -> Finding:
        """The finding without what varies from frame to frame: a value that has a bound, and the bound."""
        return self if self.bound is None else replace(self, value=None, bound=None)

    def as_dict(self) -> dict[str, object]:
        """What it has, for JSON; numbers that JSON does not know are texts."""
        known = {name: value for name, value in vars(self).items() if value not in ("", (), None)}
        return {name: str(v) if isinstance(v, float) and not math.isfinite(v) else v for name, v in known.items()}

    @classmethod
    def from_dict(cls, known: Mapping[str, object]) -> Finding:
        """The finding that `as_dict` has written."""
        kind, detail, unit, case = (str(known.get(name, "")) for name in ("kind", "detail", "unit", "case"))
        value, bound = (float(str(known[name])) if name in known else None for name in ("value", "bound"))
        subjects = tuple(cast("Sequence[str]", known.get("subjects", ())))
        return cls(kind, detail, subjects, value, bound, unit, case)


def encode_findings(findings: Sequence[Finding], size: int = FINDINGS_BYTES) -> str:
    """JSON text of findings; empty without any.

    Where all do not fit, the first ones of each kind are kept, as many as there is room for; of each kind that has
    more, a finding with the detail "omitted" counts the others.

    Args:
        findings: in their order, of each kind the most important ones first.
        size: of the text at most [bytes of UTF-8].
    """
    if not findings:
        return ""
    texts = [_json(one) for one in findings]
    if len((text := f"[{','.join(texts)}]").encode()) <= size:
        return text
    ranks, seen = [], Counter[str]()
    for one in findings:
        ranks.append(seen[one.kind])
        seen[one.kind] += 1
    room, kept = size - 2 - RESERVED * len(seen), set[int]()
    for k in sorted(range(len(findings)), key=lambda k: (ranks[k], k)):
        room -= len(texts[k].encode()) + 1
        if room < 0:
            break
        kept.add(k)
        seen[findings[k].kind] -= 1
    omitted = [_json(Finding(kind, OMITTED, value=count)) for kind, count in seen.items() if count]
    return f"[{','.join([*(texts[k] for k in sorted(kept)), *omitted])}]"


def decode_findings(text: str) -> tuple[Finding, ...]:
    """The findings of a text by `encode_findings`."""
    return tuple(map(Finding.from_dict, json.loads(text))) if text else ()


def _json(one: Finding) -> str:
    return json.dumps(one.as_dict(), ensure_ascii=False, separators=(",", ":"))
