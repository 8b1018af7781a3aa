"""Tables and pictures of recordings."""
