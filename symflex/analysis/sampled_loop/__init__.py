"""Loops that a sampled controller closes around a machine: poles in z, and where they are stable."""

from symflex.analysis.sampled_loop.closed import SampledLoop, sampled_loop
from symflex.analysis.sampled_loop.over import sampled_stability
from symflex.analysis.sampled_loop.poles import SampledPoles, sampled_poles

__all__ = ["SampledLoop", "SampledPoles", "sampled_loop", "sampled_poles", "sampled_stability"]
