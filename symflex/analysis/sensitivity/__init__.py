"""Sensitivities: how poles and zeros move with parameters, proved."""

from symflex.analysis.sensitivity.differentiate import differentiate
from symflex.analysis.sensitivity.sensitivity import RootDerivative

__all__ = ["RootDerivative", "differentiate"]
