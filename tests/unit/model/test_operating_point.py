"""Nonlinear equations and energies, against differences in fifty digits and SymPy's Lagrange equations."""

import re

import mpmath
import pytest
import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from symflex import Model, loads
from symflex.errors import SpecError
from symflex.expressions import format_expression
from tests.unit.refusals import refusal

# fmt: off
# unknowns, equations, values at rest, solve, input, values of parameters
EQUATIONS = {
    "magnetic levitation": (
        "x i", ["m*x'' = m*g - C*i^2/x^2", "L*i' + R*i = u"], {"x": "x_0", "i": "i_0", "u": "R*i_0"},
        ["i_0"], "u", {"m": 0.05, "g": 9.81, "C": 1e-4, "x_0": 0.01, "R": 2, "L": 0.02},
    ),
    "magnetic levitation, product rule": (
        "x i", ["m*x'' = m*g - Q*i^2/(2*(x + d)^2)", "(L + Q/(d + x))*i' - Q/(d + x)^2*x'*i + R*i = u"],
        {"x": "x_0", "i": "i_0", "u": "R*i_0"}, ["i_0"], "u",
        {"m": 0.05, "g": 9.81, "Q": 1e-3, "x_0": 0.01, "d": 0.004, "R": 2, "L": 0.02},
    ),
    "pendulum on a cart": (
        "x theta",
        ["(M + m)*x'' + m*l*cos(theta)*theta'' - m*l*sin(theta)*theta'^2 + b*x' = F",
         "m*l^2*theta'' + m*l*cos(theta)*x'' - m*g*l*sin(theta) = 0"],
        {}, [], "F", {"M": 1, "m": 0.2, "l": 0.3, "g": 9.81, "b": 0.1},
    ),
    "pendulum held aside": (
        "theta", ["m*l^2*theta'' + b*theta' + m*g*l*sin(theta) = tau"], {"theta": "q", "tau": "t_0"},
        ["t_0"], "tau", {"m": 0.3, "l": 0.4, "b": 0.02, "g": 9.81, "q": 0.6},
    ),
    "tank": ("h", ["A*h' = q - k*sqrt(h)"], {"h": "h_0", "q": "q_0"}, ["q_0"], "q",
             {"A": 0.5, "k": 0.01, "h_0": 2}),
    "two tanks": (
        "h_1 h_2", ["A*h_1' = q - k*sqrt(h_1 - h_2)", "A*h_2' = k*sqrt(h_1 - h_2) - k*sqrt(h_2)"],
        {"h_1": "2*h", "h_2": "h", "q": "k*sqrt(h)"}, [], "q", {"A": 0.5, "k": 0.01, "h": 1.5},
    ),
    "car with drag": ("v", ["m*v' = F - c*v^2 - m*g*sin(a)"], {"v": "V", "F": "F_0"}, ["F_0"], "F",
                      {"m": 1200, "c": 0.4, "g": 9.81, "a": 0.03, "V": 30}),
    "motor turning a fan": (
        "theta omega", ["theta' = omega", "J*omega' = tau - b*omega - c*omega^2"],
        {"omega": "W", "tau": "b*W + c*W^2"}, [], "tau", {"J": 2, "b": 0.5, "c": 0.01, "W": 20},
    ),
    "buck converter, averaged": (
        "i v", ["L*i' = d*V - v", "C*v' = i - v/R"], {"i": "D*V/R", "v": "D*V", "d": "D"}, [], "d",
        {"L": 1e-4, "C": 1e-4, "R": 5, "V": 24, "D": 0.4},
    ),
    "boost converter, averaged": (
        "i v", ["L*i' = V - (1 - d)*v", "C*v' = (1 - d)*i - v/R"],
        {"d": "D", "v": "V/(1 - D)", "i": "V/((1 - D)^2*R)"}, [], "d",
        {"L": 1e-4, "C": 1e-4, "R": 5, "V": 24, "D": 0.4},
    ),
    "diode and capacitor": ("v", ["C*v' + I*(exp(v/U) - 1) = i"], {"v": "V", "i": "I*(exp(V/U) - 1)"}, [],
                            "i", {"C": 1e-6, "I": 1e-9, "U": 0.026, "V": 0.5}),
    "hydraulic servo": (
        "x p", ["c*y*sqrt(P - p) = A*s*x + V/B*s*p", "m*s^2*x = A*p - F"],
        {"p": "p_0", "y": "0"}, ["F"], "y",
        {"c": 1e-6, "P": 1e7, "p_0": 4e6, "A": 5e-4, "V": 2e-4, "B": 1e9, "m": 20},
    ),
    "ball on a beam": (
        "r", ["(m + J/R^2)*r'' = m*r*theta'^2 - m*g*sin(theta)"], {}, [], "theta",
        {"m": 0.1, "J": 1e-5, "R": 0.01, "g": 9.81},
    ),
    "satellite": (
        "r phi", ["r'' = r*phi'^2 - k/r^2 + u", "r^2*phi'' + 2*r*r'*phi' = 0"],
        {"r": "R", "phi'": "sqrt(k/R^3)"}, [], "u", {"k": 3.98e14, "R": 7e6},
    ),
    "quadratic drag at rest": ("v", ["m*v' + b*v + c*abs(v)*v = F"], {}, [], "F", {"m": 3, "b": 2, "c": 5}),
    "absolute value": ("v", ["m*v' + c*abs(v)*v = F"], {"v": "-V", "F": "-c*V^2"}, [], "F",
                       {"m": 3, "c": 0.2, "V": 5}),
    "thermistor": ("T", ["C*T' = I^2*R*exp(b/T) - k*(T - A)"], {"T": "T_0", "I": "I_0"}, ["I_0"], "I",
                   {"C": 2, "R": 0.01, "b": 3000, "k": 0.05, "A": 290, "T_0": 350}),
    "magnet that pulls with a negative current": (
        "x y", ["m*x'' = m*g - C*i^2/x^2", "y' = x"], {"x": "x_0", "i": "i_0", "y'": "x_0"}, ["i_0"], "i",
        {"m": 0.05, "g": 9.81, "C": 1e-4, "x_0": 0.01, "i_0": -0.7},
    ),
    "a domain that is small": (
        "x", ["x' = u - sqrt(1 - D^2)*sqrt(1 - E^2)*log(1 - G)*x^2"],
        {"x": "X", "u": "X^2*log(1 - G)*sqrt((1 - D^2)*(1 - E^2))"}, [], "u",
        {"D": 0.5, "E": 0.3, "G": 0.2, "X": 2},
    ),
    "by value": ("theta", ["J*theta'' + k*theta - w*sin(theta) = tau"], {"theta": "q"}, ["q"], "tau",
                 {"J": 0.02, "k": 0.2, "w": 0.6, "q": 2}),
    "bracket": ("v", ["(m*v*cosh(v))' + b*tanh(v) = F"], {"v": "V", "F": "b*tanh(V)"}, [], "F",
                {"m": 2, "b": 3, "V": 0.7}),
    "arctangents": (
        "x y", ["x' + x*atan(y) = b*u", "y' + atan(x*y) = u"], {"x": "X", "y": "Y", "u": "atan(X*Y)"}, ["b"],
        "u", {"X": 1.5, "Y": 0.5},
    ),
    "logarithm and tangent": ("x", ["m*x'' + k*log(1 + x) + c*tan(x)*x' + x^-2 = F"],
                              {"x": "X", "F": "k*log(1 + X) + 1/X^2"}, [], "F",
                              {"m": 2, "k": 3, "c": 0.2, "X": 0.7}),
}

# fmt: on


def _text(unknowns, equations, rest, solve, source, values):
    real = {n: f'{{ value = {v}, assume = "real" }}' if v < 0 else v for n, v in values.items()}
    lines = ["symflex = 1", "[parameters]", *(f"{n} = {v}" for n, v in real.items())]
    lines += ["[inputs]", f"{source} = {{}}", "[outputs]"]
    lines += [f'O_{n} = "{n}"' for n in unknowns.split()]
    written = ", ".join(f'"{e}"' for e in equations)
    lines += ["[equations]", f"unknowns = {unknowns.split()}", f"equations = [{written}]"]
    lines += ["[operating_point]", *(f'"{n}" = "{v}"' for n, v in rest.items())]
    return "\n".join([*lines, f"solve = {solve}"])


def _slope(function, at, i):
    step = mpmath.mpf(10) ** -20
    up, down = list(at), list(at)
    up[i] += step
    down[i] -= step
    return (function(*up) - function(*down)) / (2 * step)


def _response(unknowns, equations, rest, solve, source, values, s):
    """Return the deviations at one s, from differences of the equations in fifty digits."""
    names = [*unknowns.split(), source, "q"] if "q" in rest else [*unknowns.split(), source]
    names = list(dict.fromkeys(n for n in names if n not in values))
    letters = {(n, k): sympy.Symbol(f"{n}_d{k}") for n in names for k in range(3)}

    def read(text):
        for n in names:  # brackets and s by hand: the product rule of the one model that has them
            text = re.sub(r"\(m\*v\*cosh\(v\)\)'", "m*v'*cosh(v) + m*v*sinh(v)*v'", text)
            text = re.sub(rf"s\^2\*{n}\b", f"{n}''", text)
            text = re.sub(rf"\bs\*{n}\b", f"{n}'", text)
        for n in sorted(names, key=len, reverse=True):
            for k in (2, 1, 0):
                text = re.sub(rf"\b{n}{chr(39) * k}(?![\w'])", f"{n}_d{k}", text)
        left, right = text.replace("^", "**").split("=")
        known = {n: sympy.Symbol(n) for n in (*values, *solve)}
        known |= {str(x): x for x in letters.values()} | {"abs": sympy.Abs}
        return sympy.sympify(f"({left}) - ({right})", locals=known)

    wholes = [read(e) for e in equations]
    constants = {n: sympy.Float(str(v), 50) for n, v in values.items()}
    at = dict.fromkeys(letters.values(), sympy.Integer(0))
    for n, v in rest.items():
        k = n.count("'")
        at[letters[n.rstrip("'"), k]] = sympy.sympify(
            v.replace("^", "**"), locals={m: sympy.Symbol(m) for m in (*values, *solve)}
        )
    if rest.get("omega"):
        at[letters["theta", 1]] = at[letters["omega", 0]]
    for p in solve:
        residual = next(r for w in wholes if sympy.Symbol(p) in (r := w.subs(at)).free_symbols)
        guess = constants.pop(p, sympy.Float(1))
        other = {k: v for k, v in constants.items()}
        f = sympy.lambdify(sympy.Symbol(p), residual.subs(other), "mpmath")
        constants[p] = sympy.Float(mpmath.findroot(f, mpmath.mpf(guess)), 50)
    point = [mpmath.mpf(sympy.N(v.subs(constants), 50)) for v in at.values()]
    order, size = list(letters), len(unknowns.split())
    a, b = mpmath.zeros(size), mpmath.zeros(size, 1)
    for row, whole in enumerate(wholes):
        f = sympy.lambdify([letters[x] for x in order], whole.subs(constants), "mpmath")
        assert abs(f(*point)) < mpmath.mpf(10) ** -18 * (1 + abs(max(point, key=abs)))
        for i, (n, k) in enumerate(order):
            slope = _slope(f, point, i) * s**k
            if n == source:
                b[row] -= slope
            else:
                a[row, unknowns.split().index(n)] += slope
    return mpmath.lu_solve(a, b)


@pytest.mark.parametrize("name", EQUATIONS)
def test_equations_are_those_that_differences_give(name):
    case = EQUATIONS[name]
    model = loads(_text(*case))
    s = mpmath.mpc(0.3, 1.7)
    with mpmath.workdps(50):
        expected = _response(*case, s)
    for k, n in enumerate(case[0].split()):
        value = model.transfer_function(f"O_{n}", case[4]).bind()(complex(s))
        assert value == pytest.approx(complex(expected[k]), rel=1e-9), n


# fmt: off
# coordinates, kinetic and potential energy, dissipation, values at rest (which hold), force on the first
MECHANISMS = {
    "two masses": ("x y", "m*x'^2/2 + M*y'^2/2", "k*(x - y)^2/2", "b*(x' - y')^2/2", {}),
    "pendulum": ("q", "m*l^2*q'^2/2", "-m*g*l*cos(q)", "b*q'^2/2", {}),
    "inverted pendulum on a cart": (
        "x q", "M*x'^2/2 + m*((x + l*sin(q))'^2 + (l*cos(q))'^2)/2", "m*g*l*cos(q)", "b*x'^2/2", {},
    ),
    "double pendulum": (
        "p q", "m*l^2*p'^2/2 + M*((l*sin(p) + h*sin(q))'^2 + (l*cos(p) + h*cos(q))'^2)/2",
        "-m*g*l*cos(p) - M*g*(l*cos(p) + h*cos(q))", "0", {},
    ),
    "double pendulum upside down": (
        "p q", "m*l^2*p'^2/2 + M*((l*sin(p) + h*sin(q))'^2 + (l*cos(p) + h*cos(q))'^2)/2",
        "-m*g*l*cos(p) - M*g*(l*cos(p) + h*cos(q))", "b*q'^2/2", {"q": "pi"},
    ),
    "elastic pendulum": (
        "r q", "m*(r'^2 + r^2*q'^2)/2", "k*(r - l)^2/2 - m*g*r*cos(q)", "0", {"r": "l + m*g/k"},
    ),
    "bead on a turning hoop": ("q", "m*l^2*(q'^2 + w^2*sin(q)^2)/2", "-m*g*l*cos(q)", "b*q'^2/2", {}),
    "crane": (
        "x q", "M*x'^2/2 + m*(x'^2 + l^2*q'^2 + 2*l*x'*q'*cos(q))/2", "-m*g*l*cos(q)", "b*x'^2/2", {},
    ),
    "ball on a beam": (
        "r q", "(m + M)*r'^2/2 + (J + m*r^2)*q'^2/2", "m*g*r*sin(q) + k*q^2/2", "b*r'^2/2", {},
    ),
    "Furuta": (
        "p q",
        "J*p'^2/2 + m*((l*p' + h*cos(q)*q')^2 + h^2*q'^2*sin(q)^2 + h^2*sin(q)^2*p'^2)/2",
        "m*g*h*cos(q)", "b*p'^2/2", {},
    ),
    "wheel with a mass off its centre": (
        "q", "J*q'^2/2 + m*((l*q - h*sin(q))'^2 + (h*cos(q))'^2)/2", "-m*g*h*cos(q)", "0", {},
    ),
    "three masses in a row": (
        "x y z", "m*(x'^2 + y'^2)/2 + M*z'^2/2", "k*((x - y)^2 + (y - z)^2)/2 + c*x^4/4",
        "b*(y' - z')^2/2", {},
    ),
    "block that slides on a wedge": (
        "x y", "M*x'^2/2 + m*((x + y*cos(a))'^2 + (y*sin(a))'^2)/2",
        "m*g*y*sin(a) + k*(y + m*g*sin(a)/k)^2/2",
        "b*y'^2/2", {"y": "-2*m*g*sin(a)/k"},
    ),
}
# fmt: on
NUMBERS = dict(m=0.3, M=1.1, l=0.7, h=0.4, k=25, b=0.6, g=9.81, J=0.2, w=2, c=3, a=0.5)


@pytest.mark.parametrize("name", MECHANISMS)
def test_energies_give_what_lagranges_method_gives(name):
    coordinates, kinetic, potential, lost, rest = MECHANISMS[name]
    names, used = coordinates.split(), {n: v for n, v in NUMBERS.items() if n not in coordinates.split()}
    model = Model(
        parameters={n: v for n, v in used.items() if re.search(rf"\b{n}\b", f"{kinetic} {potential} {lost}")},
        energy={
            "coordinates": names, "kinetic": kinetic, "potential": potential, "dissipation": lost,
            "forces": {names[0]: "u"},
        },
        operating_point=rest,
        inputs={"u": {}},
        outputs={f"O_{n}": n for n in names},
    )  # fmt: skip
    t = dynamicsymbols._t
    moving = {n: dynamicsymbols(n) for n in names}
    letters = {n: sympy.Symbol(n) for n in used}

    def read(text):
        for n in names:
            text = re.sub(rf"\b{n}'", f"D_{n}", text)
        text = re.sub(r"\(([^()]*(?:\([^()]*\)[^()]*)*)\)'", r"D(\1)", text).replace("^", "**")
        known = {**moving, **letters, **{f"D_{n}": f.diff(t) for n, f in moving.items()}}
        return sympy.sympify(text, locals=known | {"D": lambda f: f.diff(t), "pi": sympy.pi})

    q = [moving[n] for n in names]
    method = LagrangesMethod(read(kinetic) - read(potential), q)
    loss = [sympy.diff(read(lost), f.diff(t)) for f in q]
    whole = method.form_lagranges_equations() + sympy.Matrix(loss)
    at = {moving[n]: read(str(rest.get(n, "0"))) for n in names}
    plain = [sympy.symbols(f"v{k}_0:{len(q)}") for k in range(3)]
    swap = {f.diff(t, k): plain[k][i] for k in (2, 1, 0) for i, f in enumerate(q)}
    whole = sympy.Matrix([e.subs({f.diff(t, 2): swap[f.diff(t, 2)] for f in q}) for e in whole])
    whole = whole.subs({f.diff(t): swap[f.diff(t)] for f in q}).subs({f: swap[f] for f in q})
    still = {x: 0 for k in (1, 2) for x in plain[k]} | {plain[0][i]: at[f] for i, f in enumerate(q)}
    numbers = {letters[n]: v for n, v in used.items()}
    assert all(abs(sympy.N(e.subs(still).subs(numbers))) < 1e-12 for e in whole)
    s = 0.3 + 1.7j
    slopes = [whole.jacobian(plain[k]).subs(still).subs(numbers) for k in range(3)]
    a = slopes[0] + slopes[1] * s + slopes[2] * s**2
    expected = a.LUsolve(sympy.Matrix([1, *[0] * (len(q) - 1)]))
    for i, n in enumerate(names):
        value = model.transfer_function(f"O_{n}", "u").bind()(s)
        assert value == pytest.approx(complex(expected[i]), rel=1e-9, abs=1e-14), n


@pytest.mark.parametrize("name", [n for n, case in EQUATIONS.items() if not case[3]])
def test_what_does_not_hold_at_rest_is_refused(name):
    unknowns, (first, *others), *rest = EQUATIONS[name]
    assert refusal(loads, _text(unknowns, [f"0.001 + {first}", *others], *rest)) == "SpecError SF407"


REFUSED = {
    "x' = sat(x) - u": "SF222",
    "x' = x^0.5 - u": "SF224",
    "x' = a^x - u": "SF407",
    "x' = sgn(x) - u": "SF222",
    "x' = abs(x) - u": "SF222",
    "x' = 1/x - u": "SF224",
    "x' = s*x*x - u": "SF222",
    "x' = x*(s + 1)*x - u": "SF222",
    "x' = s*x*x^2 - u": "SF222",
    "x' = sqrt(b^2) - b + x - u": "SF407",  # b is negative
    "x' = y - u": "SF210",
    "x' = sqr(a) + x - u": "SF210",
    "a' = x - u": "SF210",
    "x' = sqrt(x) - u": "SF224",
    "x' = log(b) - log(b) + log(x + b) - log(b) - u": "SF224",
    "x' = a - x - u": "SF407",
    "x'' + x' + x*x' = u": "SF407",  # moves on
}


@pytest.mark.parametrize("equation", REFUSED)
def test_equations_without_a_linear_one_are_refused(equation):
    rest = {"x": "0", "x'": "a", "u": "a"} if "x''" in equation else {"x": "0"}
    text = _text("x", [equation], rest, [], "u", {"a": 2, "b": -1})
    assert refusal(loads, text) == f"SpecError {REFUSED[equation]}"


def test_an_s_that_can_be_read_in_two_ways_is_shown():
    with pytest.raises(SpecError, match="can be read in two ways") as refused:
        loads(_text("x", ["x' + x = s*x*x^2 + u"], {"x": "0"}, [], "u", {}))
    _, shown, marks, _ = str(refused.value).split("\n")
    assert marks.index("^") == shown.index("s*x*x^2")
    assert marks.count("^") == len("s*x*x^2")


def test_what_was_solved_for_by_value_is_solved_anew_for_other_values():
    text = _text(*EQUATIONS["by value"])
    model = loads(text)
    held = model.transfer_function("O_theta", "tau")
    assert refusal(model.stability, over="k") == refusal(model.stability, spread=0.1) == "ModelError SF801"
    assert refusal(held.bind, k=0.3) == "ModelError SF801"
    assert len(held.bind(J=0.03).poles()) == 2
    q = mpmath.findroot(lambda q: 0.3 * q - 0.6 * mpmath.sin(q), 1.9)
    pole, _ = loads(text, values={"k": 0.3}).transfer_function("O_theta", "tau").bind().poles()
    assert abs(complex(pole) ** 2 + (0.3 - 0.6 * mpmath.cos(q)) / 0.02) < 1e-9


@pytest.mark.parametrize("equation", ["m*x'' + k*sin(x) = u", "m*x'' + k*x*x = u", "m*x'' + k*x + 3 = u"])
def test_equations_that_are_not_linear_need_a_point(equation):
    text = _text("x", [equation], {}, [], "u", {"m": 2, "k": 3}).partition("[operating_point]")[0]
    assert refusal(loads, text) in ("SpecError SF222", "SpecError SF221")


def test_derivatives_in_time_leave_values_of_fields_as_they_are():
    conditions = ["w(0) = 0", "T*w'(l) = k*(x - w(l))"]
    string = {"domain": ["0", "l"], "unknowns": ["w"], "equations": ["T*w'' = rho*s^2*w"]}
    model = Model(
        parameters={"m": 2, "k": 100, "T": 10, "rho": 0.1, "l": 1},
        fields={"string": {**string, "conditions": conditions}},
        equations={"unknowns": ["x"], "equations": ["m*x'' + k*(x - w(l)) = F"]},
        inputs={"F": {}},
        outputs={"X": "x"},
    )
    wave = 0.3j  # s times sqrt(rho/T) at s = 3j
    held = 10 * wave * complex(mpmath.coth(wave))  # the string's stiffness, in series with k
    expected = 1 / (-18 + 100 * held / (100 + held))
    assert model.transfer_function("X/F").bind()(3j) == pytest.approx(expected)


# fmt: off
POINTS = {  # equation, signals, values at rest, solve
    "given and wrong": ("x' = u - x*w", {"w": "3*x"}, {"x": "a", "w": "5*a"}, ["u"], "SF407"),
    "in a loop": ("x' = u - x*w", {"w": "3*v", "v": "w/(1 + s) + x"}, {"x": "a"}, ["u"], "SF407"),
    "given and solved for": ("x' = u - x^2", {}, {"x": "a"}, ["x", "u"], "SF210"),
    "a root of a negative number": ("x' = u - x^2 - 1", {}, {}, ["x"], "SF224"),
    "a sum without a value": ("x' = u + exp(u) - x", {}, {"x": "a"}, ["u"], "SF407"),
    "a value that holds for these numbers": ("x' = u - x^2 - 1", {}, {"x": "a", "u": "2*a + 1"}, [], "SF407"),
}
# fmt: on


@pytest.mark.parametrize("name", POINTS)
def test_points_that_do_not_follow_are_refused(name):
    equation, signals, rest, solve, code = POINTS[name]
    section = {"unknowns": ["x"], "equations": [equation]}
    parts = {"equations": section, "operating_point": {**rest, "solve": solve}, "inputs": {"u": {}}}
    refused = refusal(Model, parameters={"a": 2}, signals=signals, outputs={"X": "x"}, **parts)
    assert refused == f"SpecError {code}"


@pytest.mark.parametrize(
    "part",
    ["kinetic = \"m*(l*sn(x))'^2/2\"", "kinetic = \"m*(s*x)^2/2\"", "kinetic = \"m*x''^2/2\"",
     "potential = \"m*x'\"", "kinetic = \"m*x'^2/2\"\nconstraints = [\"x' = x\"]"],
)  # fmt: skip
def test_energies_have_rates_only_where_lagranges_equations_see_them(part):
    text = 'symflex = 1\nparameters = { m = 1 }\ninputs = { F = {} }\noutputs = { X = "x" }\n[energy]\n'
    assert refusal(loads, f'{text}coordinates = ["x"]\n{part}\nforces = {{ x = "F" }}') == "SpecError SF222"


def test_a_pendulum_may_be_a_point_on_a_circle_whose_rod_pulls():
    model = Model(
        parameters={"m": "0.2 kg", "l": "0.3 m", "g": "9.81 m/s^2"},
        energy={
            "coordinates": ["x", "y"],
            "kinetic": "m*(x'^2 + y'^2)/2",
            "potential": "m*g*y",
            "forces": {"x": "F"},
            "constraints": ["x^2 + y^2 = l^2"],
        },
        operating_point={"y": "-l"},
        inputs={"F": {"unit": "N"}},
        outputs={"X": "x"},
    )
    assert str(model.transfer_function("X/F")) == "X/F = l/(m*(l*s^2 + g))"  # by hand


def test_a_coordinate_that_is_a_node_moves_with_what_is_attached_there():
    held = {"type": "spring", "between": ["x", "ground"], "k": "30 N/m"}
    energy = {"coordinates": ["x"], "kinetic": "m*x'^2/2", "potential": "c*x^2/2"}
    model = Model(
        parameters={"m": "0.2 kg", "c": "5 N/m"},
        elements={"held": held},
        energy=energy,
        inputs={"F": {"force": "x"}},
        outputs={"X": "x"},
    )
    assert complex(model.transfer_function("X/F").bind()(2j)) == pytest.approx(1 / (35 - 0.2 * 4))


def test_a_bracket_has_a_derivative_without_an_operating_point_too():
    text = _text("x", ["(m*x)' + 3*x = u"], {}, [], "u", {"m": 2}).partition("[operating_point]")[0]
    assert str(loads(text).transfer_function("O_x/u")) == "O_x/u = 1/(m*s + 3)"


def test_a_bracket_that_changes_may_be_divided_by():
    # (x^2)' is 2 x x', 0 at rest: what is left of the quotient is x/k.
    text = _text("x", ["x' + x/(k + (x^2)') = u"], {"x": "0"}, [], "u", {"k": 2})
    assert str(loads(text).transfer_function("O_x/u")) == "O_x/u = k/(k*s + 1)"


def test_a_linear_equation_is_turned_round_where_every_term_has_a_minus():
    for equation, shown in (("u = x'' + sin(x)", "s^2*x + x = u"), ("x'' - sin(x) = u", "s^2*x - x = u")):
        (linear,) = loads(_text("x", [equation], {"x": "0"}, [], "u", {})).resolved.operating_point.linear
        assert format_expression(linear) == shown


def test_outputs_and_signals_have_derivatives_in_time():
    section = {"unknowns": ["x"], "equations": ["m*x'' + b*x' + k*sin(x) = F"]}
    model = Model(
        parameters={"m": 2, "b": 3, "k": 5},
        equations=section,
        operating_point={"x": "0"},
        signals={"v": "x'"},
        inputs={"F": {}},
        outputs={"A": "x''", "V": "2*v"},
    )
    s, whole = 1 + 2j, 2 * (1 + 2j) ** 2 + 3 * (1 + 2j) + 5
    assert model.transfer_function("A/F").bind()(s) == pytest.approx(s**2 / whole)
    assert model.transfer_function("V/F").bind()(s) == pytest.approx(2 * s / whole)


# A rotor that turns at n, with a disc that nods: J_d (a'' , b'') + J_p n (b', -a') + k (a, b) = (M, 0).
NODS = ["J_d*a'' + J_p*omega*b' + k*a = M", "J_d*b'' - J_p*omega*a' + k*b = 0"]
SPEEDS = {  # equations of the speed, signals, values at rest
    "a primed signal": (["J_p*q'' = T"], {"omega": "q'"}, {"q'": "n"}),
    "a signal with s": (["J_p*q'' = T"], {"omega": "s*q"}, {"q'": "n"}),
    "a signal of a signal": (["J_p*q'' = T"], {"omega": "2*p", "p": "q'/2"}, {"q'": "n"}),
    "a rate that follows": (["q' = w", "J_p*w' = T"], {"omega": "q'"}, {"w": "n"}),
    "a rate that follows from a rate": (["p' = q'", "q' = w", "J_p*w' = T"], {"omega": "p'"}, {"w": "n"}),
    "a signal whose value is given": (["J_p*q'' = T"], {"omega": "s*q"}, {"omega": "n"}),
    "a rate with s that follows": (["s*q = w", "J_p*w' = T"], {"omega": "q'"}, {"w": "n"}),
    "a rate on the right": (["w = q'", "J_p*w' = T"], {"omega": "q'"}, {"w": "n"}),
}


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("name", SPEEDS)
def test_a_speed_at_rest_is_the_same_however_it_is_written(name, is_first):
    turns, signals, rest = SPEEDS[name]
    names = ["a", "b", *("p" for e in turns if "p'" in e), "q", *("w" for e in turns if "w'" in e)]
    model = Model(
        parameters={"J_d": 0.01, "J_p": 0.02, "k": 50, "n": 300},
        signals=signals,
        equations={"unknowns": names, "equations": [*turns, *NODS] if is_first else [*NODS, *turns]},
        operating_point=rest,
        inputs={"T": {}, "M": {}},
        outputs={"A": "a"},
    )
    s = 3 + 40j
    expected = (0.01 * s**2 + 50) / ((0.01 * s**2 + 50) ** 2 + (0.02 * 300 * s) ** 2)
    assert model.transfer_function("A/M").bind()(s) == pytest.approx(expected, rel=1e-12)


def test_two_inertias_turn_together_with_a_twisted_shaft():
    model = Model(
        parameters={"J": 2, "I": 3, "k": 5000, "c": 0.01, "n": 100},
        equations={
            "unknowns": ["p", "q"],
            "equations": ["J*p'' + k*(p - q) = T", "I*q'' - k*(p - q) = -c*q'^2"],
        },
        operating_point={"p": "twist", "p'": "n", "q'": "n", "T": "c*n^2", "solve": ["twist"]},
        inputs={"T": {}},
        outputs={"W": "q'"},
    )
    s = 2 + 7j  # the fan brakes with 2 c n
    expected = s * 5000 / ((2 * s**2 + 5000) * (3 * s**2 + 2 * 0.01 * 100 * s + 5000) - 5000**2)
    assert model.transfer_function("W/T").bind()(s) == pytest.approx(expected, rel=1e-12)


def test_a_pendulum_on_a_turning_disc_is_a_zero_of_the_order_of_its_lengths():
    """Den Hartog, Mechanical Vibrations, 5.6: the absorber is tuned to sqrt(R/L) times the speed."""
    place = "(R*{0}(q) + L*{0}(q + p))'^2"
    model = Model(
        parameters={"J": 2, "m": 0.5, "R": "90 mm", "L": "10 mm", "n": "1800 rpm"},
        energy={
            "coordinates": ["q", "p"],
            "kinetic": f"J*q'^2/2 + m/2*({place.format('cos')} + {place.format('sin')})",
            "forces": {"q": "M"},
        },
        operating_point={"q'": "n"},
        inputs={"M": {}},
        outputs={"speed": "q'"},
    )
    (zero,) = (z for z in model.transfer_function("speed/M").bind().zeros() if z.im > 0)
    assert float(zero.frequency_hz) == pytest.approx(3 * 30, rel=1e-12)


@pytest.mark.parametrize(
    "equation", ["J*q'' + k*sin(q) = T", "J*q'' + k*(q - p) = T", "J*q'' + k*load = T"], ids=str
)
def test_what_depends_on_an_angle_that_turns_is_refused(equation):
    parts = {
        "equations": {"unknowns": ["q", "p"], "equations": [equation, "J*p'' = 0"]},
        "operating_point": {"q'": "n", "p'": "2*n"},
        "signals": {"load": "2*q - 3*p"},
    }
    refused = refusal(
        Model, parameters={"J": 1, "k": 2, "n": 3}, inputs={"T": {}}, outputs={"Q": "q"}, **parts
    )
    assert refused == "SpecError SF407"


@pytest.mark.parametrize("speed", ["s*b", "b'"])
@pytest.mark.parametrize("given", ["w", "b'"])
def test_a_fan_brakes_a_shaft_of_elements_that_turns(speed, given):
    model = Model(
        parameters={"J_m": 0.01, "J_f": 0.2, "k": 300, "c": 2e-4, "n": 150},
        elements={
            "motor": {"type": "inertia", "at": "a", "J": "J_m"},
            "coupling": {"type": "torsion_spring", "between": ["a", "b"], "k": "k"},
            "fan": {"type": "inertia", "at": "b", "J": "J_f"},
            "drag": {"type": "torque_source", "at": "b", "tau": "-T_f"},
        },
        signals={"w": speed},
        equations={"unknowns": ["T_f"], "equations": ["T_f = c*w^2"]},
        operating_point={given: "n", "T_f": "c*n^2"},
        inputs={"T": {"torque": "a"}},
        outputs={"W": "b'"},
    )
    s = 2 + 7j
    expected = s * 300 / ((0.01 * s**2 + 300) * (0.2 * s**2 + 2 * 2e-4 * 150 * s + 300) - 300**2)
    assert model.transfer_function("W/T").bind()(s) == pytest.approx(expected, rel=1e-12)


def test_a_rate_is_solved_for_by_its_name():
    model = Model(
        parameters={"J": 0.2, "k": 0.3, "R": 0.5, "U": 60, "b": 0.02},
        equations={"unknowns": ["q"], "equations": ["J*q'' = k*(u - k*q')/R - b*q'"]},
        operating_point={"u": "U", "solve": ["q'"]},
        inputs={"u": {}},
        outputs={"W": "q'"},
    )
    (speed,) = model.resolved.operating_point.found
    assert float(speed.value) == pytest.approx(0.3 * 60 / 0.5 / (0.3**2 / 0.5 + 0.02))


def test_halves_and_doubles_of_energies_cancel_in_print():
    model = Model(
        parameters={"m": 1, "l": 2, "J": 3, "g": 10},
        energy={
            "coordinates": ["q"],
            "kinetic": "J/2*q'^2 + m/2*((l*sin(q))'^2 + (l*cos(q))'^2) + m*(l*q')^2/2",
            "potential": "-m*g*l*cos(q) + 3*m*g*q^2/2",
            "forces": {"q": "u"},
        },
        inputs={"u": {}},
        outputs={"Q": "q"},
    )
    ((mass,),), _, ((stiffness,),) = model.resolved.operating_point.matrices
    shown = [format_expression(entry) for entry in (mass, stiffness)]
    assert shown == ["J + 2*m*l^2", "m*g*l + 3*m*g"]  # J + m l^2 + m l^2 by hand


@pytest.mark.parametrize("wrong", ["kinetic", "potential", "dissipation", "forces"])
def test_an_energy_that_divides_by_zero_is_refused_at_its_place(wrong):
    given = {
        "kinetic": "m*x'^2/2", "potential": "k*x^2/2", "dissipation": "x'^2/2", "forces": "F"
    }  # fmt: skip
    given[wrong] += "/0"
    lines = "\n".join(
        f'{key} = {{ x = "{value}" }}' if key == "forces" else f'{key} = "{value}"'
        for key, value in given.items()
    )
    head = (
        'symflex = 1\nparameters = { m = 2, k = 3 }\ninputs = { F = {} }\noutputs = { X = "x" }\n[energy]\n'
    )
    with pytest.raises(SpecError) as raised:
        loads(f'{head}coordinates = ["x"]\n{lines}\n')
    (problem,) = raised.value.diagnostics
    assert (problem.code, problem.span.line) == ("SF224", 7 + list(given).index(wrong))
