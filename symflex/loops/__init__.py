"""Stable gains of feedback loops, proved: poles in the right half-plane counted, none missing."""

from symflex.loops.apart import poles_apart
from symflex.loops.colocation import DynamicColocation, dynamic_colocation
from symflex.loops.find import find_stable_gains
from symflex.loops.locus import (
    RootLocus,
    closed_loop,
    closed_loop_roots,
    loop_gain,
    nominal_gain,
    require_arrival,
    trace_locus,
)
from symflex.loops.loop import Loop, characteristic_loop, pick_gain
from symflex.loops.networks import AnyLoop, NetworkLoop
from symflex.loops.stability_map import StabilityMap
