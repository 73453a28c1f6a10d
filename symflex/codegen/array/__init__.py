"""Modules over any library of arrays, and over jax."""
