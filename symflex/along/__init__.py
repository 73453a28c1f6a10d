"""Waves along members that vary along x: fundamental matrices, their minors, laws with numbers."""
