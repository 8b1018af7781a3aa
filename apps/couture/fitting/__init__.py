"""Stiffness of cloth from the outline of a drape that was measured, seen from above."""
