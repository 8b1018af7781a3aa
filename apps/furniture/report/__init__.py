"""Tables and pictures of furniture."""
