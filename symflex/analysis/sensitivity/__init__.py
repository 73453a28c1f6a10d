"""Sensitivities: how poles and zeros move with parameters, proved."""

from symflex.analysis.sensitivity.sensitivity import RootDerivative
