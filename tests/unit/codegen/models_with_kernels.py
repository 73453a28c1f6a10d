"""Models with transcendental transfer functions, one for every kind of kernel and collision of names."""

from pathlib import Path

from symflex import pipeline

DERIVATIONS = Path(__file__).parents[3] / "derivations"
LUMPED = frozenset(("quarter_car",))
BEAM = 'E = "E", I = "I", rho = "rho", A = "A"'


def spec(parameters, body):
    """Return a specification with parameters that have no values."""
    table = ", ".join(f"{name} = {{}}" for name in parameters.split())
    return f"symflex = 1\nparameters = {{ {table} }}\n{body}"


MODELS = {
    "propped beam of two fields": spec(
        "E mu l",
        """[fields.v]
domain = ["0", "l"]
equation = "E*v'''' + mu*s^2*v = 0"
conditions = ["v(0) = 0", "v'(0) = 0"]
[fields.w]
domain = ["l", "2*l"]
equation = "E*w'''' + mu*s^2*w = 0"
conditions = ["w(l) = v(l)", "w'(l) = v'(l)", "w''(l) = v''(l)", "w'''(l) = v'''(l)",
  "w(2*l) = 0", "E*w''(2*l) = f"]
[inputs]
f = {}
[outputs]
Y = "v(l/2)"
""",
    ),
    "thermoelastic rod": spec(
        "a b e l",
        """[fields.rod]
unknowns = ["u", "T"]
domain = ["0", "l"]
equations = ["a*u'' - e*T' = s^2*u", "b*T'' = s*T + e*s*u'"]
conditions = ["u(0) = 0", "T'(0) = 0", "a*u'(l) - e*T(l) = f", "T(l) = 0"]
[inputs]
f = {}
[outputs]
Q = "T(0)"
""",
    ),
    "two beams": spec(
        "E I rho A l E_2 I_2 l_2 m",
        f"""inputs.F = {{ force = "p" }}
outputs.X = "r"
[elements]
one = {{ type = "beam", between = ["p", "q"], {BEAM}, l = "l" }}
two = {{ type = "beam", between = ["q", "r"], E = "E_2", I = "I_2", rho = "rho", A = "A", l = "l_2" }}
slide = {{ type = "slider", at = "p" }}
tip = {{ type = "mass", at = "r", m = "m" }}
""",
    ),
    "damped beam on a foundation": spec(
        "E I rho A l eta c_f k_f a q",
        f"""inputs.F = {{ force = "p" }}
outputs.X = "r"
[elements]
one = {{ type = "beam", between = ["p", "r"], {BEAM}, l = "l", eta = "eta", c_f = "c_f", k_f = "k_f" }}
slide = {{ type = "slider", at = "p" }}
tip = {{ type = "mass", at = "r", m = "a" }}
loss = {{ type = "damper", between = ["r", "ground"], b = "q" }}
""",
    ),
    "beam with definitions": spec(
        "E I rho A l m J",
        f"""definitions = {{ EI = "E*I", M = "m + J/l^2", load = "rho*A" }}
inputs.F = {{ force = "r" }}
outputs.X = "r"
[elements]
one = {{ type = "beam", between = ["ground", "r"], {BEAM}, l = "l" }}
tip = {{ type = "mass", at = "r", m = "m" }}
""",
    ),
    "beam under tension": spec(
        "E I rho A l N",
        f"""elements.one = {{ type = "beam", between = ["ground", "r"], {BEAM}, l = "l", N = "N" }}
inputs.F = {{ force = "r" }}
outputs.X = "r"
""",
    ),
    "rayleigh beam": spec(
        "E I rho A l c_2",
        f"""inputs.F = {{ force = "r" }}
outputs = {{ X = "r", slope = "r.theta" }}
elements.one = {{ type = "beam", between = ["ground", "r"], {BEAM}, l = "l", theory = "rayleigh" }}
""",
    ),
    "two beams of pairs": spec(
        "E I rho A l N h kappa G",
        f"""inputs.F = {{ force = "t" }}
outputs.X = "r"
[elements]
one = {{ type = "beam", between = ["ground", "r"], {BEAM}, l = "l", N = "N" }}
[elements.two]
type = "beam"
between = ["r", "t"]
theory = "timoshenko"
E = "E"
I = "I"
rho = "rho"
A = "A"
l = "h"
kappa = "kappa"
G = "G"
""",
    ),
    "damped rod": spec(
        "E A rho l eta c_f D k",
        """inputs.F = { force = "x" }
outputs = { X = "x", Y = "y" }
[elements]
bar = { type = "rod", between = ["x", "y"], E = "E", A = "A", rho = "rho", l = "l", eta = "eta", c_f = "c_f" }
end = { type = "spring", between = ["y", "ground"], k = "k" }
body = { type = "mass", at = "x", m = "D" }
""",
    ),
    "rod on a beam": spec(
        "E A I rho l h",
        f"""inputs.F = {{ force = "x" }}
outputs = {{ X = "x", Y = "r" }}
[elements]
bar = {{ type = "rod", between = ["x", "r.y"], E = "E", A = "A", rho = "rho", l = "h" }}
one = {{ type = "beam", between = ["ground", "r"], {BEAM}, l = "l" }}
""",
    ),
    "string with a bead": spec(
        "N rho A l x_s m",
        """inputs.F = { force = "y" }
outputs.Y = "y"
[elements]
one = { type = "string", between = ["ground", "y"], N = "N", rho = "rho", A = "A", l = "x_s" }
two = { type = "string", between = ["y", "ground"], N = "N", rho = "rho", A = "A", l = "l - x_s" }
bead = { type = "mass", at = "y", m = "m" }
""",
    ),
    "shafts and a gear": spec(
        "G J rho l n J_m k_f",
        """inputs.t = { torque = "a" }
outputs.angle = "d"
[elements]
one = { type = "shaft", between = ["a", "b"], G = "G", J = "J", rho = "rho", l = "l" }
gear = { type = "transformer", from = "b", to = "c", ratio = "n" }
two = { type = "shaft", between = ["c", "d"], G = "G", J = "J", rho = "rho", l = "l/2", k_f = "k_f" }
disc = { type = "inertia", at = "a", J = "J_m" }
""",
    ),
    "delay and rod": spec(
        "E A rho l T K",
        """[elements]
bar = { type = "rod", between = ["x", "ground"], E = "E", A = "A", rho = "rho", l = "l" }
push = { type = "force_source", at = "x", f = "K*late*u" }
[inputs]
u = {}
[outputs]
X = "x"
X_late = "late*x"
[blocks]
late = { type = "delay", T = "T" }
""",
    ),
    "loop with a delay": spec(
        "m T K omega j",
        """[elements]
body = { type = "mass", at = "x", m = "m" }
push = { type = "force_source", at = "x", f = "u - K*late*x - omega*j*x" }
[inputs]
u = {}
[outputs]
X = "x"
[blocks]
late = { type = "delay", T = "T" }
""",
    ),
    "diffusion with drift": spec(
        "v k l D",
        """[fields.c]
domain = ["0", "l"]
equation = "D*c'' - v*c' - (s + k)*c = 0"
conditions = ["c(0) = u", "c'(l) = 0"]
[inputs]
u = {}
[outputs]
Out = "c(l)"
""",
    ),
    "third order": spec(
        "b k l",
        """[fields.c]
domain = ["0", "l"]
equation = "c''' + b*s*c' + (s^2 + k)*c = 0"
conditions = ["c(0) = u", "c'(0) = 0", "c''(l) = 0"]
[inputs]
u = {}
[outputs]
Out = "c(l)"
""",
    ),
    "the paper's names taken": spec(
        "E I rho A l x_s S C p a T",
        """[fields.w]
domain = ["0", "l"]
equation = "E*I*w'''' + rho*A*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "E*I*w'''(l) = -F*S*C*p*a*T"]
[inputs]
F = {}
[outputs]
W = "w(x_s)"
""",
    ),
    "numbers": spec(
        "l",
        """[fields.w]
domain = ["0", "l"]
equation = "3*w'''' + 0.5*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = 0", "w''(l) = 0", "w(l) = F"]
[inputs]
F = {}
[outputs]
slope = "w'(0)"
""",
    ),
}


def derived(name):
    """Return the transfer functions of a case."""
    path = next(DERIVATIONS.glob(f"*/{name}.toml"), None)
    model = pipeline.loads(MODELS[name]) if path is None else pipeline.load(path)
    return pipeline.derive_all(model)


NAMES = (
    *MODELS,
    *sorted(p.stem for p in (DERIVATIONS / "classics").glob("*.toml") if p.stem not in LUMPED),
    "sliding_free_beam",
    "robot_axis",
)
