"""Undamped systems: functions that are real on both axes, and their roots there."""
