"""Edit sessions of furniture."""
