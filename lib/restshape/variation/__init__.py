"""Sweeps: one scene with one value after the other, what each run gives, and its table and picture."""
