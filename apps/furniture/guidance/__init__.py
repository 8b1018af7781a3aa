"""Suggestions: what would mend a piece that does not hold."""
