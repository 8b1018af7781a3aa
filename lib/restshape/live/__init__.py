"""Live sessions: a person's hand in a browser drives the simulation that scripts drive."""
