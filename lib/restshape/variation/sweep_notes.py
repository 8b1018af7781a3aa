"""What a sweep says of how its values were found, in its table, its JSON file and its picture."""

from collections.abc import Sequence


def sweep_notes(remembered: Sequence[str]) -> list[str]:
    """Says that each run starts from rest, and why; empty where nothing remembers its path.

    Args:
        remembered: parts of the physics whose equilibria depend on the path to them.
    """
    if not remembered:
        return []
    return [f"each run starts from rest: equilibria depend on the path to them ({', '.join(remembered)})"]
