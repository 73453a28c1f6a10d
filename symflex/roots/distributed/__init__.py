"""Roots of functions with kernels: searched, counted and enclosed."""
