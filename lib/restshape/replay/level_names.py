"""What tables call the levels of reuse and the frames of level 0, by their keys in summaries."""

LEVEL_NAMES = {
    "idle": "0 idle",
    "values": "0 values changed",
    "analysed": "0 analysed",
    "still": "0 solved",
    "1": "1 relocation",
    "2": "2 reconnection",
    "3": "3 reconstruction",
    "all": "1 to 3",
}
"""Of level 0, where nothing moved: frames that solved (`still`), or these by what they are, and the idle rest."""
