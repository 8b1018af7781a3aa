"""What each part of a frame of furniture is, in the table of `restshape explain`."""

FRAME_PARTS = {
    "edit": "the script: reading an edit and closing joints",
    "mesh": "the model of the piece as it is",
    "observation": "quantities",
    "record": "residual of each frame",
}
