"""State equations as modules."""
