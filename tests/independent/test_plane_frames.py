"""Plane frames against dynamic stiffness matrices in numbers, and against published frequencies."""

import itertools

import numpy as np
import pytest
from mpmath import mp, mpf, pi

from benchmarks.frames import specification
from symflex import pipeline
from symflex.analysis.sensitivity.sensitivity import sensitivities
from symflex.roots import Modes
from tests.independent.plane_frames import Member, clamped, determinant, response

POINTS = (30 + 400j, 700j, -5 + 4000j, 20000 + 1000j)
STEEL = {"E": mpf("210e9"), "I": mpf("1e-8"), "A": mpf("1e-4"), "rho": mpf(7800)}
VALUES = 'E = "210 GPa", I = "1e-8 m^4", A = "1e-4 m^2", rho = "7800 kg/m^3"'
HALF = mpf(1) / 2


def frame(name, first, second, angle, length="0.5 m"):
    """Return the line of a member of steel."""
    ends = f'between = ["{first}", "{second}"]'
    return f'{name} = {{ type = "frame", {ends}, {VALUES}, l = "{length}", angle = {angle} }}\n'


def bound(elements, outputs, force="c.y"):
    """Return what each output does per force or torque, with numbers in place."""
    kind = "torque" if force.endswith("theta") else "force"
    shown = "\n".join(f'O_{i} = "{o}"' for i, o in enumerate(outputs))
    model = pipeline.loads(
        f'symflex = 1\n[elements]\n{elements}\n[inputs]\nF = {{ {kind} = "{force}" }}\n[outputs]\n{shown}\n'
    )
    return pipeline.derive_bound(model, model.transfer_functions)


def is_response(functions, outputs, members, held, force="c.y", added=lambda s: {}):
    """Tell whether transfer functions have the values of dynamic stiffness matrices."""
    at = {name: tuple(name.split(".")) for name in (*outputs, force)}
    return all(
        abs(function(s) / response(members, held, at[force], at[shown], s, added(s)) - 1) < 1e-11
        for function, shown in zip(functions, outputs, strict=True)
        for s in POINTS
    )


@pytest.mark.slow
def test_an_l_frame_has_the_response_of_its_dynamic_stiffness():
    outputs = ("c.y", "b.x", "b.theta")
    wall = 'wall = { type = "fixed", at = "a" }\n'
    for written, angle in (('"90 deg"', pi / 2), ('"-120 deg"', -2 * pi / 3), (0.3, mpf("0.3"))):
        found = bound(wall + frame("column", "a", "b", written) + frame("boom", "b", "c", 0), outputs)
        members = [Member("a", "b", **STEEL, l=HALF, angle=angle), Member("b", "c", **STEEL, l=HALF)]
        assert is_response(found, outputs, members, clamped("a")), written


def on(joint, **values):
    """Return what stands on the diagonal of the stiffness for components of a joint."""
    return {((joint, c), (joint, c)): value for c, value in values.items()}


@pytest.mark.slow
def test_a_hinge_shares_translations_and_a_body_adds_its_inertia():
    outputs = ("c.y", "c.x", "b.theta")
    found = bound(
        frame("column", "ground", "b", '"60 deg"')
        + frame("boom", "h", "c", 0)
        + 'hinge = { type = "pin", between = ["b", "h"] }\n'
        'joint = { type = "torsion_spring", between = ["b.theta", "ground"], k = "40 N*m/rad" }\n'
        'elbow = { type = "torsion_spring", between = ["h.theta", "ground"], k = "300 N*m/rad" }\n'
        'load = { type = "rigid_body", at = "c", m = "0.3 kg", J = "0.001 kg*m^2" }\n'
        'foot = { type = "spring", between = ["c.x", "ground"], k = "20 kN/m" }\n',
        outputs,
    )
    members = [Member("a", "b", **STEEL, l=HALF, angle=pi / 3), Member("b'", "c", **STEEL, l=HALF)]

    def added(s):
        inertia = mpf("0.3") * s**2
        body = on("c", x=inertia + 20000, y=inertia, theta=mpf("0.001") * s**2)
        return body | on("b", theta=40) | on("b'", theta=300)

    assert is_response(found, outputs, members, clamped("a"), added=added)


def test_a_rigid_link_at_an_angle_carries_a_body_beside_and_above_its_node():
    """A mass at (r_x, r_y) from the node moves by x - r_y*theta and y + r_x*theta."""
    outputs = ("b.y", "b.x", "b.theta")
    found = bound(
        frame("column", "ground", "b", '"90 deg"')
        + 'offset = { type = "rigid_link", between = ["b", "c"], length = "0.1 m", angle = "30 deg" }\n'
        'load = { type = "rigid_body", at = "c", m = "0.3 kg" }\n',
        outputs,
        "b.y",
    )
    members = [Member("a", "b", **STEEL, l=HALF, angle=pi / 2)]
    r_x, r_y = mp.sqrt(3) / 20, mpf(1) / 20

    def added(s):
        m = mpf("0.3") * s**2
        x, y, theta = (("b", c) for c in ("x", "y", "theta"))
        coupled = {(x, theta): -m * r_y, (theta, x): -m * r_y, (y, theta): m * r_x, (theta, y): m * r_x}
        return on("b", x=m, y=m, theta=m * (r_x**2 + r_y**2)) | coupled

    assert is_response(found, outputs, members, clamped("a"), "b.y", added)


def test_the_modes_of_a_portal_frame_are_where_its_determinant_changes_sign():
    """Both kinds, sway and symmetric, appear: the force is at one corner."""
    portal = (
        frame("left", "ground", "p", '"90 deg"')
        + frame("right", "ground", "q", '"90 deg"')
        + frame("beam", "p", "q", 0)
    )
    mapped = mapped_at("p.x", f"[elements]\n{portal}", 4)
    assert mapped.certificate.certified
    members = [
        Member("a", "p", **STEEL, l=HALF, angle=pi / 2),
        Member("d", "q", **STEEL, l=HALF, angle=pi / 2),
        Member("p", "q", **STEEL, l=HALF),
    ]
    with mp.workdps(30):
        for pole in (p for p in mapped.poles if p.im > 0):
            omega = mpf(str(float(pole.im.mid())))
            low, high = (determinant(members, clamped("a", "d"), omega + d) for d in (-1e-6, 1e-6))
            assert low * high < 0


@pytest.mark.slow
def test_roots_of_a_two_storey_frame_move_as_its_determinant_says():
    """Poles of ``det K``, zeros of K held at the force: ``ds/dp = -(dD/dp)/(dD/ds)``, by differences of D."""
    given = {"I_1": mpf("2e-8"), "l_1": mpf("0.4"), "m": mpf("0.7")}
    legs = (("left", "ground", "p"), ("right", "ground", "q"), ("up", "p", "r"), ("far", "q", "t"))
    text = "".join(frame(name, a, b, '"90 deg"') for name, a, b in legs)
    text = text.replace('I = "1e-8 m^4"', 'I = "I_1"', 1).replace('l = "0.5 m"', 'l = "l_1"', 1)
    text += frame("floor", "p", "q", 0) + frame("roof", "r", "t", 0)
    text += 'body = { type = "mass", at = "r.x", m = "m" }\n'
    table = '[parameters]\nI_1 = "2e-8 m^4"\nl_1 = "0.4 m"\nm = "0.7 kg"\n'
    model = pipeline.loads(
        f'symflex = 1\n{table}[elements]\n{text}[inputs]\nF = {{ force = "r.x" }}\n[outputs]\nx = "r.x"\n'
    )
    (bound,) = pipeline.derive_for_roots(model, [("x", "F")])
    moved = sensitivities(model, bound, pipeline.roots(bound, Modes(2), 15))

    def determinant_of(omega, kind, values):
        left = {**STEEL, "I": values["I_1"]}
        members = [Member("a", "p", **left, l=values["l_1"], angle=pi / 2)]
        members += [Member(a, b, **STEEL, l=HALF, angle=pi / 2) for a, b in ("dq", "pr", "qt")]
        members += [Member(a, b, **STEEL, l=HALF) for a, b in ("pq", "rt")]
        held = clamped("a", "d") | ({("r", "x")} if kind == "zero" else set())
        return determinant(members, held, omega, on("r", x=-values["m"] * omega**2))

    assert len(moved) == 2 * 4 * 3
    with mp.workdps(40):
        for each in (m for m in moved if m.root.im > 0):
            name, omega = each.parameter.name, mpf(each.place.imag.mid().str(35, radius=False))
            step = given[name] * mpf(10) ** -10
            beside = [
                determinant_of(omega, each.kind, given | {name: given[name] + d}) for d in (step, -step)
            ]
            ahead = [determinant_of(omega + d, each.kind, given) for d in (step, -step)]
            right = float(-(beside[0] - beside[1]) / (ahead[0] - ahead[1]))
            assert each.status == "certified"
            assert float(each.derivative.real.mid()) == pytest.approx(0, abs=1e-25)
            assert float(each.derivative.imag.mid()) == pytest.approx(right, rel=1e-9, abs=1e-12)


CROSS = 'E = "200 GPa", I = "a^4/12", A = "a^2", rho = "8000 kg/m^3", l = "5 m"'


def cross(arms, modes=2):
    """Return the map of a NAFEMS pin-ended cross at its centre; sections are square."""
    turn = 360 // arms
    lines = "".join(
        f'arm_{i} = {{ type = "frame", between = ["c", "e_{i}"], {CROSS}, angle = "{i * turn} deg" }}\n'
        f'pin_{i} = {{ type = "pin", at = "e_{i}" }}\n'
        for i in range(arms)
    )
    return mapped_at("c.x", f'parameters.a = "0.125 m"\n[elements]\n{lines}', modes)


def mapped_at(place, elements, modes):
    """Return the poles and zeros of a driving point."""
    tail = f'[inputs]\nF = {{ force = "{place}" }}\n[outputs]\nO = "{place}"\n'
    model = pipeline.loads(f"symflex = 1\n{elements}{tail}")
    (found,) = pipeline.derive_for_roots(model, [("O", "F")])
    return pipeline.roots(found, Modes(modes))


def frequencies(roots):
    """Return the frequencies of what lies on the upper half of the imaginary axis [Hz]."""
    return sorted(float(r.im.mid()) / float(2 * pi) for r in roots if r.im > 0)


@pytest.mark.slow
def test_the_pin_ended_cross_has_the_published_frequencies():
    """NAFEMS, Selected Benchmarks for Natural Frequency Analysis, 1987, test 1.

    Modes at 11.336, 45.345 Hz (every arm pinned at both ends) and 17.709, 57.390 Hz (clamped at the centre)
    are not moved by a force on the centre. Those that are lie a little below the latter, as it gives way.
    """
    found = cross(4)
    assert {11.336, 17.709, 45.345} <= {round(f, 3) for f in frequencies(h.root for h in found.hidden)}
    assert [round(f, 3) for f in frequencies(found.zeros)] == [17.709, 57.39]
    assert [f < g for f, g in zip(frequencies(found.poles), (17.709, 57.39), strict=True)] == [True, True]


@pytest.mark.slow
def test_the_pin_ended_double_cross_has_the_published_frequencies_as_often_as_they_are():
    """NAFEMS, Selected Benchmarks for Natural Frequency Analysis, 1987, test 2 (FV2).

    11.336 Hz once, 17.709 Hz for modes 2 and 3 (which the moving centre lowers) and 4 to 8, 45.345 Hz once,
    57.390 Hz for modes 10 and 11, lowered too, and 12 to 16.
    """
    found = cross(8)
    upper = [(h.root, h.root.multiplicity) for h in found.hidden if h.root.im > 0]
    upper += [(p, p.multiplicity) for p in found.poles if p.im > 0]
    counted = sorted(round(float(r.im.mid()) / float(2 * pi), 3) for r, times in upper for _ in range(times))
    assert (
        counted == [11.336, *[17.681] * 2, *[17.709] * 5, 45.345, *[57.075] * 2, *[57.39] * 5][: len(counted)]
    )


def test_the_modes_of_a_braced_frame_of_many_members_are_where_its_determinant_changes_sign():
    """Two bays with braces at 45 and 60 degrees; the expanded form would be larger than memory."""
    written = [
        ("a", "p", 90, HALF),
        ("d", "q", 90, HALF),
        ("p", "q", 0, HALF),
        ("a", "q", 45, mp.sqrt(2) / 2),
        ("q", "r", 30, HALF),
        ("r", "e", -60, mpf(1)),
    ]
    lines = "[elements]\n"
    for i, (*ends, angle, length) in enumerate(written):
        nodes = ("ground" if end in "ade" else end for end in ends)
        lines += frame(f"m_{i}", *nodes, f'"{angle} deg"', f"{mp.nstr(length, 30)} m")
    mapped = mapped_at("p.x", lines, 4)
    members = [Member(a, b, **STEEL, l=x, angle=angle * pi / 180) for a, b, angle, x in written]
    assert len(mapped.poles) == 8
    with mp.workdps(30):
        for pole in (p for p in mapped.poles if p.im > 0):
            omega = mpf(str(float(pole.im.mid())))
            low, high = (determinant(members, clamped("a", "d", "e"), omega + d) for d in (-1e-6, 1e-6))
            assert low * high < 0


def finite_element(length, E, inertia_moment, A, rho):
    """Return the consistent stiffness and mass of an element along x (Przemieniecki 1968, chapter 11)."""
    k, m = np.zeros((6, 6)), np.zeros((6, 6))
    k[np.ix_([0, 3], [0, 3])] = E * A / length * np.array([[1, -1], [-1, 1]])
    m[np.ix_([0, 3], [0, 3])] = rho * A * length / 6 * np.array([[2, 1], [1, 2]])
    x = length
    bending = [
        [12, 6 * x, -12, 6 * x],
        [6 * x, 4 * x**2, -6 * x, 2 * x**2],
        [-12, -6 * x, 12, -6 * x],
        [6 * x, 2 * x**2, -6 * x, 4 * x**2],
    ]
    inertia = [
        [156, 22 * x, 54, -13 * x],
        [22 * x, 4 * x**2, 13 * x, -3 * x**2],
        [54, 13 * x, 156, -22 * x],
        [-13 * x, -3 * x**2, -22 * x, 4 * x**2],
    ]
    at = np.ix_([1, 2, 4, 5], [1, 2, 4, 5])
    k[at], m[at] = E * inertia_moment / x**3 * np.array(bending), rho * A * x / 420 * np.array(inertia)
    return k, m


def finite_element_frequencies(storeys, parts):
    """Return the angular frequencies of :func:`specification`'s frame, each member cut into some elements."""
    steel = (210e9, 8.36e-5, 5.38e-3, 7850.0)
    places = {}
    pieces = []

    def place(x, y):
        return places.setdefault((round(x, 9), round(y, 9)), len(places))

    for i in range(storeys):
        members = [((x, 3.0 * i), (x, 3.0 * i + 3)) for x in (0.0, 6.0)]
        for (x, y), (x_2, y_2) in [*members, ((0.0, 3.0 * i + 3), (6.0, 3.0 * i + 3))]:
            along = [(x + (x_2 - x) * j / parts, y + (y_2 - y) * j / parts) for j in range(parts + 1)]
            pieces += itertools.pairwise(along)
    whole = [np.zeros((3 * 4 * parts * storeys * 3,) * 2) for _ in range(2)]
    for (x, y), (x_2, y_2) in pieces:
        length = np.hypot(x_2 - x, y_2 - y)
        c, s = (x_2 - x) / length, (y_2 - y) / length
        turn = np.kron(np.eye(2), [[c, s, 0], [-s, c, 0], [0, 0, 1]])
        a, b = place(x, y), place(x_2, y_2)
        at = np.ix_(
            [*range(3 * a, 3 * a + 3), *range(3 * b, 3 * b + 3)],
            [*range(3 * a, 3 * a + 3), *range(3 * b, 3 * b + 3)],
        )
        for matrix, part in zip(whole, finite_element(length, *steel), strict=True):
            matrix[at] += turn.T @ part @ turn
    free = [3 * p + c for (_, y), p in places.items() if y > 0 for c in range(3)]
    stiffness, mass = (matrix[np.ix_(free, free)] for matrix in whole)
    factor = np.linalg.inv(np.linalg.cholesky(mass))
    return np.sqrt(np.linalg.eigvalsh(factor @ stiffness @ factor.T))


@pytest.mark.slow
def test_a_frame_of_ten_storeys_has_the_modes_of_finite_elements_and_no_other():
    """Frequencies of finite elements lie above, by less than 0.1 % with four elements a member."""
    model = pipeline.loads(specification(10))
    (found,) = pipeline.derive_for_roots(model, [("X", "F")])
    mapped = pipeline.roots(found, Modes(10))
    assert mapped.certificate.certified
    omega = sorted(float(p.im.mid()) for p in mapped.poles if p.im > 0)
    ratios = finite_element_frequencies(10, 4)[:10] / omega
    assert ((1 < ratios) & (ratios < 1.001)).all()
