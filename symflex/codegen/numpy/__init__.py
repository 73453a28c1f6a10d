"""Modules that import numpy only."""
