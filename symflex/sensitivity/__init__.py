"""Sensitivities: how poles and zeros move with parameters, proved."""

from symflex.sensitivity.differentiate import differentiate
from symflex.sensitivity.sensitivity import Sensitivity

__all__ = ["Sensitivity", "differentiate"]
