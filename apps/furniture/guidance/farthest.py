"""How far suggestions may move things, in relation to the piece."""

FARTHEST = 0.2
"""How far a suggestion moves any corner of a plank at most where a scene says nothing, in parts of the longest side."""
