"""What is declared in rpm is answered in rpm: stable ranges, charts, spreads, sweeps and their figures."""

import math
import re

import pytest

import symflex
from symflex.errors import UsageError
from symflex.options import StabilityOptions
from tests.unit.refusals import refusal

# Internal damping c_i and external damping c_e: stable below sqrt(k/m) (1 + c_e/c_i), by hand 60 rad/s.
ROTOR = """symflex = 1
[parameters]
m = "1 kg"
k = "900 N/m"
c_i = "3 N*s/m"
c_e = { value = "3 N*s/m", spread = "1 %" }
Omega = { value = "300 rpm", spread = "30 rpm", assume = "nonnegative" }
[inputs]
F = { unit = "N" }
[outputs]
X = "x"
[equations]
unknowns = ["x", "y"]
equations = [
    "m*s^2*x + (c_e + c_i)*s*x + k*x + c_i*Omega*y = F",
    "m*s^2*y + (c_e + c_i)*s*y + k*y - c_i*Omega*x = 0",
]
"""
LIMIT = 60 * 30 / math.pi  # rpm


@pytest.fixture
def rotor():
    return symflex.loads(ROTOR)


def test_a_stable_range_prints_in_rpm_and_its_json_stays_in_hertz(rotor):
    for given in ({"gain": "Omega"}, {"over": "Omega"}):
        found = rotor.stability(**given)
        text = str(found)
        assert text.startswith("Omega [rpm]"), given
        assert float(re.findall(r"< Omega < ([\d.]+)", text)[-1]) == pytest.approx(LIMIT, rel=1e-12)
        assert "Omega = 300: stable" in text
        (boundary,) = found.to_json_dict()["boundaries"]
        assert float(boundary["gain"]["value"]) == pytest.approx(LIMIT / 60, rel=1e-12)
        assert found.to_json_dict()["unit"] == "Hz"


def test_a_chart_and_a_spread_print_in_rpm(rotor):
    chart = str(rotor.stability(over=("Omega", "c_e"), ranges={"Omega": ("60 rpm", "1200 rpm")}))
    assert "Omega [rpm], c_e [N*s/m]" in chart
    assert "examined: 60 < Omega < 1200" in chart
    spread = str(rotor.stability(spread=""))
    (row,) = (line.split() for line in spread.splitlines() if "Omega" in line)
    assert row[:4] == ["Omega", "[rpm]", "270", "330"]


def test_figures_have_axes_in_rpm(rotor):
    (strip,) = rotor.stability_plot("Omega").axes
    assert "rpm" in strip.get_xlabel()
    assert strip.get_xlim()[1] == pytest.approx(3000)
    (chart,) = rotor.stability_plot(("Omega", "c_e"), ranges={"Omega": ("60 rpm", "1200 rpm")}).axes
    assert "rpm" in chart.get_xlabel()
    assert chart.get_xlim() == pytest.approx((60, 1200))


def test_a_range_is_in_the_unit_that_is_written_and_a_bare_number_is_refused():
    model = symflex.loads(ROTOR).resolved
    from symflex.loops.over import stability_over

    found = stability_over(model, StabilityOptions(over=("Omega",), limits=("0", "30 rad/s")))
    assert float(found.limits[1]) == pytest.approx(30 / (2 * math.pi), rel=1e-15)
    with pytest.raises(UsageError, match="SF203"):
        stability_over(model, StabilityOptions(over=("Omega",), limits=("0", "1000")))


def test_a_sweep_prints_and_draws_in_rpm(rotor):
    sweep = rotor.sweep({"Omega": "60 rpm:600 rpm:lin:4"}, of="poles")
    assert "Omega = 60 to 600 rpm, 4 values" in str(sweep)
    assert sweep["Omega"].tolist() == [1, 4, 7, 10]


def test_only_zero_may_be_set_without_a_unit():
    assert symflex.loads(ROTOR, values={"Omega": 0}).transfer_function("X", "F").bind()(0j).real == (
        pytest.approx(1 / 900)
    )
    assert refusal(lambda: symflex.loads(ROTOR, values={"Omega": 300})) == "UsageError SF203"
