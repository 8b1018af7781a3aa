"""What a recording says in numbers: time a level, quantities; and tables in Markdown."""

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from restshape.replay.columns import UNTRUSTED, error_column, jump_column, quantity_column, quantity_names
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN
from restshape.replay.recorded_places import SINGULAR_PLACES, RecordedPlaces, decode_places
from restshape.replay.recording.recording import Recording
from restshape.replay.rounding import ROUNDING, cleared, largest, scales, without_rounding
from restshape.replay.same_texts import severity, without_numbers
from restshape.replay.summary import percentiles
from restshape.report.field import physics_of
from restshape.report.recorded_quantities import limit_series, quantity_units


def column(recording: Recording, name: str, default: float = np.nan) -> np.ndarray:
    """A column of numbers; filled with the default where the recording lacks it."""
    values = recording.table.get(name)
    return np.full(recording.n, default) if values is None else np.asarray(values, dtype=float)


def rows_of(recording: Recording) -> list[dict[str, Any]]:
    """The rows of all frames."""
    return [row_of(recording, i) for i in range(recording.n)]


def row_of(recording: Recording, i: int) -> dict[str, Any]:
    """The row of one frame."""
    return {name: values[i] for name, values in recording.table.items()}


def refused(recording: Recording) -> np.ndarray:
    """Whether each frame was refused (n,)."""
    reasons = recording.table.get("refused", [""] * recording.n)
    return np.array([bool(reason) for reason in reasons], dtype=bool)


def untrusted(recording: Recording) -> np.ndarray:
    """Whether the answer of each frame (n,) is not to be trusted, though it is one."""
    reasons = recording.table.get(UNTRUSTED, [""] * recording.n)
    return np.array([bool(reason) for reason in reasons], dtype=bool)


def predicted(recording: Recording) -> np.ndarray:
    """Whether each frame (n,) was predicted, and not solved."""
    return column(recording, "predicted", 0.0) == 1


def with_values(recording: Recording) -> np.ndarray:
    """Whether each frame (n,) changed values only, such as a load: the shape rests, and the system was solved.

    The hand may drag values too, where physics declare it: such frames count whether a system was solved or not.
    """
    dragged = {event for one in physics_of(recording) for event in one.value_drags}
    known = {"set", "undo", "redo", *dragged}
    events = recording.table.get("event", [""] * recording.n)
    solved = (column(recording, "iterations") > 0) | np.array([event in dragged for event in events], dtype=bool)
    return np.array([event in known for event in events], dtype=bool) & (column(recording, "level") == 0) & solved


def analysed(recording: Recording) -> np.ndarray:
    """Whether each frame (n,) was solved because its script asked for it, while the shape rests."""
    events = recording.table.get("event", [""] * recording.n)
    return np.array([event == "analyse" for event in events], dtype=bool) & (column(recording, "level") == 0)


def solved_at_rest(recording: Recording) -> np.ndarray:
    """Whether each frame (n,) changed nothing and was solved all the same, as each one is in time."""
    rests = (column(recording, "level") == 0) & (column(recording, "iterations") > 0)
    return rests & ~with_values(recording) & ~analysed(recording)


def level_table(recording: Recording) -> list[dict[str, Any]]:
    """A row a level: level, frames, p50, p95, p99 [ms], iterations (mean a frame).

    The first frame is left out, as it is made from nothing; "still" are frames that changed nothing and were solved,
    as in time, "values" those that changed values only and were solved, as an
    undo that brings back a drape is not, "analysed" those that were solved when asked to, "all" is every
    later frame whose shape moved. Refused frames that show the shape before them are in no row.
    """
    later = np.arange(recording.n) > 0
    level, ms, iterations = (column(recording, name) for name in ("level", "ms", "iterations"))
    valued, asked, still = with_values(recording) & (iterations > 0), analysed(recording), solved_at_rest(recording)
    rows = []
    idle = (level == 0) & ~valued & ~asked & ~still & ~refused(recording)
    rests = [("idle", idle), ("still", still), ("values", valued), ("analysed", asked)]
    for name, chosen in [*rests, *((str(k), level == k) for k in (1, 2, 3)), ("all", level > 0)]:
        chosen = chosen & later
        times, counts = ms[chosen], iterations[chosen]
        known = percentiles(times[np.isfinite(times)]) if len(times) else dict.fromkeys(("p50", "p95", "p99"))
        counts = counts[counts >= 0]
        mean = float(counts.mean()) if len(counts) else None
        rows.append({"level": name, "frames": int(chosen.sum()), **known, "iterations": mean})
    return rows


def first_time(recording: Recording) -> float | None:
    """The time of the first frame [ms]; None where the recording lacks it."""
    ms = float(column(recording, "ms")[0])
    return ms if np.isfinite(ms) else None


def estimate_table(recording: Recording) -> list[dict[str, Any]]:
    """A row a kind of error that the recording reports: error, frames, p50, max; without frames that lack it."""
    ahead = predicted(recording)
    kinds = (
        ("estimate, of the mesh", "estimate", ~ahead),
        ("estimate, of a time step", "estimate_time", ~ahead),
        ("estimate, of predicted frames", "estimate", ahead),
        ("predicted against solved", "prediction_error", ~ahead),
    )
    rows = []
    for kind, name, chosen in kinds:
        values = column(recording, name)[chosen]
        values = values[np.isfinite(values)]
        if len(values):
            distribution = {"p50": float(np.median(values)), "max": float(values.max())}
            rows.append({"error": kind, "frames": len(values), **distribution})
    return rows


def convergence_counts(recording: Recording) -> dict[str, int]:
    """How many frames have converged, of these in a stable equilibrium and not to be trusted, and how many have not.

    Frames that show a prediction are none of these. Nothing where the recording is of what is not relaxed to
    equilibrium.
    """
    if "converged" not in recording.table:
        return {}
    judged, stays = column(recording, "converged"), column(recording, "tangent_positive_definite") == 1
    rests = judged == 1
    counts = {"converged": rests, "tangent_positive_definite": rests & stays}
    counts |= {"untrusted": rests & untrusted(recording), "not_converged": judged == 0}
    return {name: int(frames.sum()) for name, frames in counts.items()}


def quantity_table(recording: Recording) -> list[dict[str, Any]]:
    """A row a quantity of interest: quantity, first, last, min, max, unit; None where there is no number.

    What is rounding alone is 0.
    """
    units, sizes = quantity_units(recording.header), quantity_scales(recording)
    rows = []
    for name in quantity_names(recording.table):
        values = without_rounding(column(recording, quantity_column(name)), sizes[name])
        finite = values[np.isfinite(values)]
        found = (values[0], values[-1], finite.min(), finite.max()) if len(finite) else (None,) * 4
        numbers = [float(v) if v is not None and np.isfinite(v) else None for v in found]
        row = dict(zip(("first", "last", "min", "max"), numbers, strict=True))
        more = quantity_extras(recording, name, sizes[name])
        rows.append({"quantity": name, **row, **more, "unit": units.get(name, "")})
    return rows


def quantity_scales(recording: Recording) -> dict[str, float]:
    """What counts as the size of each quantity (`rounding.scales`)."""
    series = {name: column(recording, quantity_column(name)) for name in quantity_names(recording.table)}
    loads = recording.header.get("load_scales")
    return scales(series, quantity_units(recording.header), loads if isinstance(loads, dict) else None)


def singular(recording: Recording) -> dict[str, float]:
    """Quantities that are taken at singular places in a frame, with the least exponent of displacements there."""
    known = recording.header.get("singular")
    found = {name: float(value) for name, value in known.items()} if isinstance(known, dict) else {}
    for text in dict.fromkeys(recording.table.get(SINGULAR_PLACES, ())):
        for name, value in decode_places(text).exponents.items():
            found[name] = min(value, found.get(name, value))
    return found


def places_of_frame(recording: Recording, i: int) -> RecordedPlaces:
    """What frame i has at singular places; none in recordings that do not say."""
    return decode_places(str(recording.table.get(SINGULAR_PLACES, [""] * recording.n)[i]))


def at_singular_places(recording: Recording, name: str) -> np.ndarray:
    """Whether a quantity is taken at a singular place in each frame (n,); of earlier recordings, in the first one."""
    texts = recording.table.get(SINGULAR_PLACES)
    if texts is None:
        return np.full(recording.n, name in singular(recording))
    known = {text: name in decode_places(text).exponents for text in dict.fromkeys(texts)}
    return np.array([known[text] for text in texts], dtype=bool)


def quantity_extras(recording: Recording, name: str, scale: float) -> dict[str, Any]:
    """What a recording knows of a quantity besides its values: largest `error`, or "singular"; `at_least`, `at_most`.

    Only what there is. A quantity at a singular place is singular whether its error was to be estimated or not.
    """
    found: dict[str, Any] = {}
    errors = column(recording, error_column(name))
    if np.isinf(errors).any() or name in singular(recording):
        found["error"] = "singular"
    elif np.isfinite(errors).any():
        found["error"] = cleared(float(np.nanmax(errors)), scale)
    given = limit_series(recording).get(name, {})
    # Of one that moves the last one, beside the last value.
    return found | {w: float(given[key][-1]) for w, key in (("at_least", "min"), ("at_most", "max")) if key in given}


def jumped(recording: Recording, least: float) -> np.ndarray:
    """Frames (k,) in which the mesh alone makes a quantity jump by more than a share of its largest size.

    Those at singular places, and those that are zero but for rounding, are left out.
    """
    frames = np.zeros(recording.n, dtype=bool)
    for name, scale in quantity_scales(recording).items():
        size = largest(column(recording, f"q_{name}"))
        if size > ROUNDING * scale:
            large = np.abs(np.nan_to_num(column(recording, jump_column(name)))) > least * size
            frames |= large & ~at_singular_places(recording, name)
    return np.flatnonzero(frames)


def note_table(recording: Recording, column: str = "note") -> list[tuple[int, str, str]]:
    """All notes of a recording: the line of the script, the frames in a row that have it, and what there is to note.

    Of notes that differ by numbers alone, that of the worst frame, by `severity`; of refused frames, of the first.
    """
    found: list[tuple[int, str, str]] = []
    if not {"line", "index", column} <= recording.table.keys():
        return found
    noted = ((int(row["line"]), int(row["index"]), row[column] or "") for row in rows_of(recording))
    for (line, _), same in groupby(noted, key=lambda row: (row[0], without_numbers(row[2]))):
        frames = list(same)
        (_, first, note), (_, last, _) = frames[0], frames[-1]
        if not note:
            continue
        _, at, note = frames[0] if column == "refused" else max(frames, key=lambda row: severity(row[2]))
        worst = f", worst {at}" if at != first else ""
        found.append((line, f"{first} to {last}{worst}" if len(frames) > 1 else f"{first}", note))
    return found


def status_counts(recording: Recording) -> dict[str, int]:
    """How many frames have each constraint status; nothing where none has one."""
    words = [str(word) for word in recording.table.get("constraint_status", ())]
    return {word: words.count(word) for word in (HOLDS, UNCERTAIN, FAILS) if word in words}


def markdown_table(columns: Sequence[str], rows: Iterable[Sequence[Any]], right: Sequence[str] = ()) -> str:
    """A Markdown table; columns named in ``right`` are aligned to the right, None is an empty cell."""
    rules = ["---:" if name in right else "---" for name in columns]
    lines = [_line(columns), _line(rules), *(_line([_cell(value) for value in row]) for row in rows)]
    return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    text = f"{value:.4g}" if isinstance(value, float) else str(value)
    return text.replace("|", "\\|").replace("\n", " ")
