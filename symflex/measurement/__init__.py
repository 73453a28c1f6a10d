"""Measured frequency responses."""
from symflex.measurement.measured_response import MeasuredResponse
__all__ = ["MeasuredResponse"]
