"""Several bars side by side: the scale that they make."""
