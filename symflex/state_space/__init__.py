"""State equations whose states are quantities of the model, exact, and rounded once."""

from symflex.state_space.realise import Channel, State, StateSpace, not_rational, realise, realise_quotient
from symflex.state_space.reduction import minimal
