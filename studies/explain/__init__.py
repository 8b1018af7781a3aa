"""What a scene calls for, and what each of its effects costs."""
