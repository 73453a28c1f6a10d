"""Mode shapes: the motion of everything at a pole, taken from the equations and enclosed in balls."""

from symflex.analysis.modes.find import lowest_modes, mode_shape, mode_shapes
from symflex.analysis.modes.shape import DistributedShape, EnclosedModeShape
