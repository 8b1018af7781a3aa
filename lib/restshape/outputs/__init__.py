"""Files that commands write: which may be replaced, how they are written whole, and who writes a recording."""
