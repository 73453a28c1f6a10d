"""Certified norms on the imaginary axis: the largest singular value, and the H2 norm."""
