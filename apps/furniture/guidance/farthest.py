"""How far suggestions may move things, in relation to the piece."""

FARTHEST = 0.5
"""How far a suggestion moves any corner of a plank at most where a scene says nothing, in parts of the longest side."""
NEAR = 0.2
"""The same where something holds that moves no corner farther than this."""
