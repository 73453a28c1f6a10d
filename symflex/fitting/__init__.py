"""Fitting resonances to measured frequency responses, with standard errors and the paper's phase test."""

from symflex.fitting.fit import Base, Fit, fit_resonances
from symflex.fitting.mode_shapes import FittedModeShapes, mode_shapes
from symflex.fitting.order import CRITERIA, STARTS, Score
from symflex.fitting.phase_test import PartedBand, PhaseTest
from symflex.fitting.resonances import Resonances

__all__ = [
    "CRITERIA",
    "STARTS",
    "Base",
    "Fit",
    "FittedModeShapes",
    "PartedBand",
    "PhaseTest",
    "Resonances",
    "Score",
    "fit_resonances",
    "mode_shapes",
]
