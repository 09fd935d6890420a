"""Our sine and cosine against the C library's."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.sea.trig import sincos


@njit
def all_sincos(angle, sine, cosine):
    for i in range(angle.shape[0]):
        sine[i], cosine[i] = sincos(angle[i])


def test_sine_and_cosine_are_right_to_rounding_in_every_quadrant_and_far_out():
    quarters = np.arange(-4000, 4001) * (np.pi / 4.0)
    far = np.random.default_rng(1).uniform(-1e6, 1e6, 20000)
    angle = np.concatenate([quarters, quarters + 1e-9, quarters - 1e-9, far, np.linspace(-10.0, 10.0, 20001)])
    sine, cosine = np.empty_like(angle), np.empty_like(angle)
    all_sincos(angle, sine, cosine)
    assert np.abs(sine - np.sin(angle)).max() < 3e-16
    assert np.abs(cosine - np.cos(angle)).max() < 3e-16


def test_a_loop_in_vector_instructions_gives_the_bits_of_single_calls():
    angle = np.random.default_rng(2).uniform(-1e4, 1e4, 999)
    sine, cosine = np.empty_like(angle), np.empty_like(angle)
    all_sincos(angle, sine, cosine)
    assert [sincos(a) for a in angle] == list(zip(sine, cosine, strict=True))
