"""Fitting resonances to measured frequency responses, with standard errors and the paper's phase test."""

from symflex.data.fitting.fit import Base, ResonanceFit, are_in_time, fit_resonances
from symflex.data.fitting.minimum_phase import PhaseTest
from symflex.data.fitting.mode_shapes import FittedModeShapes, mode_shapes
from symflex.data.fitting.order import STARTS
from symflex.data.fitting.parameter_fit import ParameterFit
from symflex.data.fitting.resonances import Resonances
from symflex.data.fitting.stabilisation import StablePoles, stabilisation
