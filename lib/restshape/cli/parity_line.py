"""What `restshape replay --parity` prints."""

from typing import Any

from restshape.outputs.si_numbers import counted


def parity_lines(found: dict[str, Any]) -> list[str]:
    """Lines that say in how many frames reuse equals cold solves, of which kinds, and which were left out and why.

    Args:
        found: as `replay.parity.Parity.summary` gives it.
    """
    compared, failed = sum(found["compared"].values()), sum(found["failed"].values())
    if not compared:
        first = "parity with cold solves: FAILS: no frame was compared"
    elif failed:
        first = (
            f"parity with cold solves: FAILS in {failed} of {counted(compared, 'frame')} ({_kinds(found['failed'])})"
        )
    else:
        frames = found["frames"]
        every = f"all {counted(frames, 'frame')}" if frames > 1 else "the frame"
        of = every if compared == frames else f"{compared} of {counted(frames, 'frame')}"
        first = f"parity with cold solves: holds for {of}"
    lines = [
        f"{first}; entries differ by at most {found['entries']:.1e} relative, solutions by {found['solution']:.1e} "
        f"(tolerance {found['tolerance']:.0e})",
    ]
    if compared:
        lines.append(f"  compared: {_kinds(found['compared'])}")
    if found["left_out"]:
        lines.append(f"  left out: {_kinds(found['left_out'])}")
    if found["prediction"] is not None:
        lines.append(f"  predicted frames: at most {100 * found['prediction']:.2g} % from the solved answer")
    return lines


def _kinds(counts: dict[str, int]) -> str:
    """Kinds of frames with how many there are of each."""
    return ", ".join(f"{count} {kind}" for kind, count in counts.items())
