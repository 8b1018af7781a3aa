"""Analyses: each a small class with `solve`, which keeps what it can from frame to frame."""
