"""Roots of polynomials: split exactly, isolated and enclosed."""
