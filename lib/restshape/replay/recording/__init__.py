"""Recordings: written by a process of their own as VTKHDF through a journal, and read again, whole or damaged."""
