"""Pictures of cloth and of the bodies that it lies on."""
