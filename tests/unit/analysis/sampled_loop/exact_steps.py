"""Sampled loops by matrix exponentials in doubles, which share no code with the package."""

import numpy as np
import scipy.linalg
import scipy.signal


def held_plant(num, den, period, delay):
    """Return matrices of one step of a plant whose input is held, late by a delay of any length."""
    a, b, c, d = scipy.signal.tf2ss(num, den)
    n = len(a)
    whole = int(np.ceil(delay / period - 1e-12))
    ahead = whole * period - delay

    def step(time):
        grown = scipy.linalg.expm(np.block([[a, b], [np.zeros((1, n + 1))]]) * time)
        return grown[:n, :n], grown[:n, n:]

    late, older = step(period - ahead)
    f, newer = step(ahead)
    f, older = f @ late, f @ older
    if not whole:
        return f, older + newer, c, d
    size = n + whole  # u[k - whole] ... u[k - 1]
    big, inputs = np.zeros((size, size)), np.zeros((size, 1))
    big[:n, :n], big[:n, n : n + 1] = f, older
    if whole > 1:
        big[:n, n + 1 : n + 2] = newer
        big[n : size - 1, n + 1 : size] = np.eye(whole - 1)
    else:
        inputs[:n] = newer
    inputs[size - 1] = 1
    return big, inputs, np.hstack([c, np.zeros((1, whole))]), np.zeros((1, 1))


def closed_poles(plant, controller, period, delay=0.0):
    """Return the poles in z of a plant in s and a controller in z with negative feedback."""
    f, g, c, d = held_plant(*plant, period, delay)
    cf, cg, cc, cd = scipy.signal.tf2ss(*controller)
    # e = -y, u = cc x + cd e, y = c w + d u
    inverse = 1 / (1 + cd * d)
    u_w, u_x = -inverse * (cd @ c), inverse * cc
    e_w, e_x = -(c + d @ u_w), -(d @ u_x)
    return np.linalg.eigvals(np.block([[f + g @ u_w, g @ u_x], [cg @ e_w, cf + cg @ e_x]]))
