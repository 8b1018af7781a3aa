"""Mannequins: closed surfaces of bodies by their measures."""
