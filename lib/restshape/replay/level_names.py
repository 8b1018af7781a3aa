"""What tables and pictures call the levels of reuse and the frames of level 0."""

MOVES = {1: "relocation", 2: "reconnection", 3: "reconstruction"}
"""What a mesh that follows a shape may do, by the level of reuse."""
LEVEL_NAMES = {
    "idle": "0 idle",
    "values": "0 values changed",
    "analysed": "0 analysed",
    "still": "0 solved",
    **{str(level): f"{level} {move}" for level, move in MOVES.items()},
    "all": "1 to 3",
}
"""By their keys in summaries.

Of level 0, where nothing moved: frames that solved (`still`), or these by what they are, and the idle rest."""
