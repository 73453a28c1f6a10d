"""Counting roots by how far an argument turns, with proof."""
