"""Guidance: where a design stays valid, and which edits make it valid again."""
