"""What verifies each application: references, hard cases, the thesis's numbers and random scenes."""
