"""Searching the s plane: cells that are counted and cut, and boxes and discs that certify roots in them."""
