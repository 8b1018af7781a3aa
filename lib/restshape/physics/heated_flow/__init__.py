"""Heat and buoyancy in fluids: temperatures that a flow carries, and flows that temperatures drive."""
