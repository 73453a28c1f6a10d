"""Printed formulas: forms, and the notations they are written in."""
