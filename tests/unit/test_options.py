"""What a command is asked reads alike from texts and from numbers."""

from dataclasses import FrozenInstanceError, fields, is_dataclass
from fractions import Fraction

import click
import pytest

from symflex import options
from symflex.cli import COMMANDS, group
from symflex.errors import UsageError
from symflex.options import RootsOptions, axis_ends, band_ends, tolerance
from symflex.roots.region import region_of

OF_A_COMMAND = {
    name.removesuffix("Options").lower(): kind
    for name, kind in vars(options).items()
    if name.endswith("Options") and is_dataclass(kind)
}


def test_every_field_is_a_parameter_of_its_command():
    for name in sorted(OF_A_COMMAND):
        command = group.get_command(click.Context(group), name)
        assert isinstance(command, click.Command), name
        assert {f.name for f in fields(OF_A_COMMAND[name])} <= {p.name for p in command.params}, name


def test_options_belong_to_commands():
    assert set(OF_A_COMMAND) <= set(COMMANDS)


def test_a_band_reads_alike_as_text_and_as_numbers():
    assert band_ends(("0.1", "1 kHz")) == band_ends((0.1, 1000)) == (Fraction(1, 10), Fraction(1000))


def test_an_axis_reads_alike_as_text_and_as_numbers():
    assert axis_ends(("-60 dB", "20"), "--ylim") == axis_ends((-60, 20.0), "--ylim") == (-60.0, 20.0)


def test_a_tolerance_may_have_its_unit():
    assert tolerance("3 dB", "--magnitude", ("dB",), "1 dB") == tolerance(3, "--magnitude", ("dB",), "1 dB")


def test_two_regions_are_refused_by_the_names_they_were_given_by():
    for mark in ["", "--"]:
        with pytest.raises(UsageError, match=f"{mark}modes, {mark}mode, {mark}band and {mark}region"):
            region_of(RootsOptions(modes=1, mode=2), mark)


def test_options_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        RootsOptions().modes = 3
