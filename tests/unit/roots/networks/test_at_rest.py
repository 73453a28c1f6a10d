"""Numbers modulo a prime in place of functions of constants."""

from symflex.equations.equations import ConstantFunction
from symflex.expressions import Call, Name
from symflex.roots.networks.at_rest import PRIME, place_on_circles


def test_cosine_and_sine_of_one_angle_lie_on_a_circle_and_nothing_else_is_moved():
    angles, point = ("a", "b"), {"sqrt(m)": 5}
    constants = [ConstantFunction("sqrt(m)", Call("sqrt", Name("m")))]
    for angle in angles:
        for n, function in enumerate(("cos", "sin"), 7):
            constants.append(ConstantFunction(f"{function}({angle})", Call(function, Name(angle))))
            point[constants[-1].generator] = n * (2 + len(angle * n) + ord(angle))
    place_on_circles(constants, point, PRIME)
    assert point["sqrt(m)"] == 5
    for angle in angles:
        cosine, sine = point[f"cos({angle})"], point[f"sin({angle})"]
        assert (cosine**2 + sine**2) % PRIME == 1 and 0 not in (cosine, sine)
    assert point["cos(a)"] != point["cos(b)"]
