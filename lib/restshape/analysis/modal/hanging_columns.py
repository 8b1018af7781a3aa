"""Names of the columns of hanging points."""

PLACES = ("hang_1_x", "hang_1_y", "hang_2_x", "hang_2_y")
"""Where the two places are [m]."""
NOTE = "hang_note"
"""Why there are none; empty where there are."""


def loss_columns(modes: int) -> list[str]:
    """Of what the places take from so many modes."""
    return [f"hang_loss_{k}" for k in range(1, modes + 1)]
