"""Replays: the frame loop and the recorder. The recorder's modules never import PETSc; `loop` does."""
