"""What a fuzz has tried, and what came of it: counts that go on from those of a run before."""

from collections import Counter
from dataclasses import asdict, dataclass, field
from typing import Any, Self

COUNTERS = ("warned", "messages")


@dataclass
class Found:
    """A fault, with the files that show it.

    Args:
        seed: of the batch.
        kind: "crash", "hang", or "fault": a traceback, or a number that is none.
        signature: what distinguishes it from others.
        what: its message.
        folder: scene, edits and `example.json`; empty where nobody asked to keep them.
        command: which replays them in that folder.
        seen: how often.
    """

    seed: int
    kind: str
    signature: str
    what: str
    folder: str = ""
    command: str = ""
    seen: int = 1


@dataclass
class Part:
    """Examples that were played by one code.

    Args:
        commit: that was checked out; "+" at the end where sources were changed since; the version without a checkout.
        examples: how many.
        seconds: wall-clock.
    """

    commit: str
    examples: int = 0
    seconds: float = 0.0


# More than 15 attributes: each is a count of the table that a campaign gives.
@dataclass
class Tried:
    """What was tried, and what came of it.

    Args:
        batches: that were played: the seed of the next one is so much above the first one's.
        examples: played in all; shrinking: more that were played to make those at fault smaller.
        valid: that gave frames to the end; refused: with a message, as a whole; too_large: with a first mesh of more
            elements than wanted, which ended there; broken: at fault.
        damaged: of all, those with damage to valid files; written: those that `restshape replay` replayed too.
        repeated: that were silent for too long, and were played again by themselves.
        mutated: by what was done to examples, how many ended how.
        frames, refused_frames: over all examples.
        seconds: wall-clock; processor_seconds: of the processes that played.
        largest: elements of a first mesh.
        warned: warnings that numpy gave, with how often; messages: first lines of the refusals, likewise.
        found: faults.
        parts: examples by the code that played them.
    """

    batches: int = 0
    examples: int = 0
    shrinking: int = 0
    valid: int = 0
    refused: int = 0
    too_large: int = 0
    broken: int = 0
    damaged: int = 0
    written: int = 0
    repeated: int = 0
    frames: int = 0
    refused_frames: int = 0
    seconds: float = 0.0
    processor_seconds: float = 0.0
    largest: int = 0
    warned: Counter = field(default_factory=Counter)
    messages: Counter = field(default_factory=Counter)
    mutated: dict[str, Counter] = field(default_factory=dict)
    found: dict[str, Found] = field(default_factory=dict)
    parts: list[Part] = field(default_factory=list)

    def ended(self, mutator: str, outcome: str) -> None:
        """Count an example that ended so; one without an outcome is a smaller one of a fault."""
        if outcome:
            self.mutated.setdefault(mutator, Counter())[outcome] += 1

    def begin_part(self, commit: str) -> None:
        """From now on this code plays the examples."""
        if not self.parts or self.parts[-1].commit != commit:
            self.parts.append(Part(commit))

    def as_dict(self) -> dict[str, Any]:
        """The numbers for `--json`."""
        apart = (*COUNTERS, "mutated", "found", "parts")
        table = {key: value for key, value in vars(self).items() if key not in apart}
        report = {"warned": dict(self.warned), "messages": dict(self.messages.most_common())}
        mutated = {name: dict(sorted(ends.items())) for name, ends in sorted(self.mutated.items())}
        parts, faults = ([asdict(one) for one in ones] for ones in (self.parts, self.found.values()))
        return {**table, "parts": parts, "mutated": mutated, **report, "faults": faults}

    @classmethod
    def of(cls, table: dict[str, Any]) -> Self:
        """What `as_dict` gave.

        Raises:
            KeyError, TypeError: something lacks, or is of another kind.
        """
        plain = {key: table[key] for key, value in vars(cls()).items() if isinstance(value, int | float)}
        counters = {key: Counter(table[key]) for key in COUNTERS}
        mutated = {name: Counter(ends) for name, ends in table["mutated"].items()}
        found = {one["signature"]: Found(**one) for one in table["faults"]}
        return cls(**plain, **counters, mutated=mutated, found=found, parts=[Part(**one) for one in table["parts"]])
