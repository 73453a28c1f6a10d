"""Frequency responses: accurate values, phase without guesswork, grids that miss no resonance."""

from symflex.analysis.response.frequency_response import FrequencyResponse
from symflex.analysis.response.grid import adaptive_grid, default_band, roots_if_found
from symflex.analysis.response.respond import respond

__all__ = ["FrequencyResponse", "adaptive_grid", "default_band", "respond", "roots_if_found"]
