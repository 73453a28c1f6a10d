"""The random networks of lumped elements, as hypothesis draws them."""

from tests import random_models
from tests.random_models import drawn, to_toml

__all__ = ["networks", "passive_networks", "reciprocal_networks", "to_toml"]


def networks():
    """Draw a network of any elements, with signals, blocks and sources."""
    return drawn(random_models.networks)


def passive_networks():
    """Draw a network without sources of power other than its one input; its output is at that input."""
    return drawn(random_models.passive_networks)


def reciprocal_networks():
    """Draw a passive network with inputs U_1, U_2 and the outputs Y_1, Y_2 that belong to them."""
    return drawn(random_models.reciprocal_networks)
