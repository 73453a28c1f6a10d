"""Modes that delays and waves take out exactly, and those that they nearly do."""

from symflex import pipeline
from symflex.roots.distributed.proof import Proof
from symflex.roots.distributed.side import Side

TEXT = """
symflex = 1
parameters = {{ k = "100 N/m", m = "0.3 kg", z = 0.1 }}
definitions.w = "sqrt(k/m)"
definitions.T = "{period}"
inputs.r = {{}}
outputs.y = "{shaper}*{mode}*r"
"""
MODE = "w^2/(s^2 + w^2)"
SHAPED = [  # period, shaper, mode, word, how many poles it hides on the axis
    # exp(-j w T) is -1, 1, 1, and exp(-j pi/3) of a sixth of a turn, with 1 - q + q^2 = 0.
    ("pi/w", "(1 + exp(-s*T))/2", MODE, "stable", 2),
    ("2*pi/w", "(1 - exp(-s*T))/(s*T)", MODE, "stable", 2),
    ("4*pi/w", "((1 - exp(-s*T))/(s*T))^2", MODE, "stable", 2),
    ("pi/(3*w)", "(1 - exp(-s*T) + exp(-2*s*T))", MODE, "stable", 2),
    ("2*pi/(5*w)", "(1 + exp(-s*T) + exp(-2*s*T) + exp(-3*s*T) + exp(-4*s*T))/5", MODE, "stable", 2),
    # A double mode keeps one pair of poles; one that is missed by little is seen.
    ("pi/w", "(1 + exp(-s*T))/2", f"({MODE})^2", "marginal", 2),
    ("2.0000001*pi/w", "(1 - exp(-s*T))/(s*T)", MODE, "marginal", 0),
    ("pi/w", "(1 - exp(-s*T))/(s*T)", MODE, "marginal", 0),
    # exp(-s T) = -exp(z pi/sqrt(1 - z^2)) at the pole: it decays, seen or not.
    (
        "pi/(w*sqrt(1 - z^2))",
        "(1 + exp(-z*pi/sqrt(1 - z^2))*exp(-s*T))",
        "w^2/(s^2 + 2*z*w*s + w^2)",
        "stable",
        0,
    ),
    ("1/w", "exp(-s*T)*(s^2 + w^2)/(s + w)^2", MODE, "stable", 2),
]


def _map(text):
    model = pipeline.loads(text)
    return pipeline.roots(pipeline.derive_bound(model, model.transfer_functions)[0])


def test_a_mode_is_hidden_where_a_delay_takes_it_out_exactly():
    for period, shaper, mode, word, count in SHAPED:
        found = _map(TEXT.format(period=period, shaper=shaper, mode=mode))
        axis = [h for h in found.hidden if h.is_proved and h.root.re.contains(0)]
        hidden = [h for h in axis if not h.root.is_zero]
        assert (found.verdict.word, len(hidden)) == (word, count), (period, shaper)
        # What divides by s integrates: the delay takes its motion out.
        at_rest = [h for h in axis if h.root.is_zero]
        integrators = (2 if "^2" in shaper else 1) * ("/(s*T)" in shaper)
        assert sum(h.root.multiplicity for h in at_rest) == integrators, (period, shaper)
        assert ("imaginary axis" in found.verdict.hidden) is (count > 0), (period, shaper)


def test_a_ramp_of_one_period_of_a_frequency_in_hertz_leaves_no_pole():
    found = _map("""
symflex = 1
parameters.f_n = "42.5 1/s"
definitions.T = "1/f_n"
definitions.w = "2*pi*f_n"
inputs.x_cmd = { unit = "m" }
outputs.x = "w^2/(s^2 + w^2)*((1 - exp(-s*T))/(s*T))^2*x_cmd"
""")
    headline = "stable, with 2 hidden poles at s = 0 and 2 on the imaginary axis"
    assert (found.verdict.headline, found.poles) == (headline, ())


def test_a_notch_at_the_first_mode_of_a_rod_hides_it_exactly(monkeypatch):
    # cos(w l/c) = 0 of a rod that is held at one end, with w = pi c/(2 l).
    for length, is_hidden, is_searched_again in [("2*L", 1, 0), ("2.00001*L", 0, 0), ("2*L", 1, 1)]:
        if is_searched_again:
            monkeypatch.setattr(Side, "counted", lambda self: Proof(0, 0, "for this test"))
        found = _map(f"""
symflex = 1
parameters = {{ E = "200 GPa", rho = "7800 kg/m^3", A = "1 cm^2", L = "1 m" }}
definitions.w = "pi/({length})*sqrt(E/rho)"
signals.f = "(s^2 + w^2)/(s + w)^2*F"
elements.rod = {{ type = "rod", between = ["ground", "u"], E = "E", A = "A", rho = "rho", l = "L" }}
elements.drive = {{ type = "force_source", at = "u", f = "f" }}
inputs.F = {{ unit = "N" }}
outputs.U = "u"
""")
        assert [h.is_proved for h in found.hidden] == [True, True] * is_hidden, length
        assert found.certificate.certified, length
        assert ("subdivision" in found.certificate.engine) is bool(is_searched_again), length


def test_a_shaped_force_on_a_mass_and_a_spring_hides_their_mode():
    # exp(-s T) = -1 at s^2 = -k/m; the structure is passive, which alone says nothing of the axis.
    found = _map("""
symflex = 1
parameters = { m = "0.3 kg", k = "100 N/m" }
definitions.T = "pi*sqrt(m/k)"
elements.body = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
elements.drive = { type = "force_source", at = "x", f = "(1 + exp(-s*T))/2*F" }
inputs.F = { unit = "N" }
outputs.X = "x"
""")
    assert found.verdict.headline == "stable, with 2 hidden poles on the imaginary axis"
