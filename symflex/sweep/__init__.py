"""Sweeps: a design of parameter points, each solved, the results put in order and named.

Input: a model, a :class:`Design` of values, and what is wanted at each point. Output: a :class:`Sweep` of
labelled arrays. What is computed at a point depends on nothing but the points of its chunk before it, so that
neither the number of workers, nor the order in which they finish, nor a restart in between changes a byte of
the result.
"""

from symflex.sweep.design import Design, Range, Task, design_of, read_design
from symflex.sweep.labelled import Labelled, Sweep
from symflex.sweep.points import QUANTITIES
from symflex.sweep.run import chunk_size, plan_sweep, run_sweep, sweep, sweep_key, sweep_task
