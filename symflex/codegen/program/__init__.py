"""Numeric programs in no language yet: how to compute a transfer function, and how well that works."""
