"""Frequency responses: accurate values, phase without guesswork, grids that miss no resonance."""

from symflex.analysis.response.frequency_response import SampledResponse, respond
from symflex.analysis.response.grid import adaptive_grid, default_band, roots_if_found

__all__ = ["SampledResponse", "adaptive_grid", "default_band", "respond", "roots_if_found"]
