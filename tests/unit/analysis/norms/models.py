"""Models whose norms are known otherwise."""

import mpmath as mp

import symflex

EI, RHO_A, LENGTH, ETA = 140, "0.162", "0.8", "0.0002"


def cantilever(stiffness="EI*(1 + eta*s)"):
    """Return a cantilever with material damping, tip force to tip displacement."""
    return symflex.Model(
        parameters={"EI": "140 N*m^2", "rhoA": "0.162 kg/m", "l": "0.8 m", "eta": "0.2 ms"},
        elements={
            "arm": {
                "type": "beam",
                "between": ["ground", "tip"],
                "EI": stiffness,
                "rhoA": "rhoA",
                "l": "l",
            }
        },
        inputs={"F": {"force": "tip"}},
        outputs={"X": "tip"},
    )


def squares_of_frequencies(count):
    """Return omega_n^2 of its modes without damping: 1 + cos(x) cosh(x) = 0."""
    with mp.workdps(40):
        guesses = (mp.mpf("1.8751"), *((2 * n + 1) * mp.pi / 2 for n in range(1, count)))
        wavenumbers = [mp.findroot(lambda x: mp.cos(x) * mp.cosh(x) + 1, guess) for guess in guesses]
        unit = EI / mp.mpf(RHO_A) / mp.mpf(LENGTH) ** 4
        return [float(x**4 * unit) for x in wavenumbers]


def response(omega):
    """Return the cantilever's receptance at a frequency [rad/s]: sin cosh - cos sinh over 1 + cos cosh."""
    with mp.workdps(30):
        s, eta, length = mp.mpc(0, omega), mp.mpf(ETA), mp.mpf(LENGTH)
        x = (mp.mpf(RHO_A) * mp.mpf(omega) ** 2 * length**4 / EI / (1 + eta * s)) ** mp.mpf("0.25")
        above = mp.sin(x) * mp.cosh(x) - mp.cos(x) * mp.sinh(x)
        below = x**3 * (1 + mp.cos(x) * mp.cosh(x))
        return complex(length**3 / EI / (1 + eta * s) * above / below)


def two_masses():
    """Return two masses on springs and dampers between two walls."""
    elements = {
        "m_1": {"type": "mass", "at": "x_1", "m": "m"},
        "m_2": {"type": "mass", "at": "x_2", "m": "m"},
    }
    for n, ends in enumerate((["ground", "x_1"], ["x_1", "x_2"], ["x_2", "ground"]), 1):
        elements[f"k_{n}"] = {"type": "spring", "between": ends, "k": "k"}
        elements[f"b_{n}"] = {"type": "damper", "between": ends, "b": "b"}
    return symflex.Model(
        parameters={"m": "1 kg", "k": "100 N/m", "b": "0.2 N*s/m"},
        elements=elements,
        inputs={"F_1": {"force": "x_1"}, "F_2": {"force": "x_2"}},
        outputs={"X_1": "x_1", "X_2": "x_2"},
    )
