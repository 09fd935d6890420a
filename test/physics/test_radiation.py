"""The water's memory: its kernel against the transfer function it was made from, and the laws it must keep."""

import numpy as np
import pytest
from gunnerus_ship import DATA, SHIP
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.physics.radiation import add_memory_load, radiation_count

MEMORY = SHIP.radiation
COUNT = radiation_count(MEMORY)
compiled = settings(deadline=None)


def rate_and_load(memory, velocity):
    rate, load = np.zeros(COUNT), np.zeros(6)
    add_memory_load(load, MEMORY, memory, velocity, rate)
    return rate, load


def follow(velocities, step):
    """Loads (n, 6) for velocities (n, 6), by the exponential of the linear system with velocities held."""
    columns = np.array([rate_and_load(unit, np.zeros(6))[0] for unit in np.eye(COUNT)]).T
    driving = np.array([rate_and_load(np.zeros(COUNT), unit)[0] for unit in np.eye(6)]).T
    values, vectors = np.linalg.eig(columns)
    grown = np.exp(values * step)
    inverse = np.linalg.inv(vectors)
    free = (vectors * grown @ inverse).real
    held = (vectors * ((grown - 1.0) / values) @ inverse).real @ driving
    memory, loads = np.zeros(COUNT), []
    for velocity in velocities:
        memory = free @ memory + held @ velocity
        loads.append(rate_and_load(memory, velocity)[1])
    return np.array(loads)


def test_there_are_forty_eight_states():
    assert COUNT == 48


@pytest.mark.parametrize("omega", [0.4, 1.0, 1.5, 3.0])
@pytest.mark.parametrize("mode", range(6))
def test_harmonic_motion_gives_the_load_of_the_transfer_function(mode, omega):
    step = 0.005
    time = step * np.arange(1, round(60.0 / step))
    velocities = np.zeros((len(time), 6))
    velocities[:, mode] = np.cos(omega * (time - 0.5 * step))  # held values act half a step late
    loads = follow(velocities, step)
    last = time > 60.0 - 2.0 * np.pi / omega * np.floor(30.0 * omega / (2.0 * np.pi))
    found = 2.0 * (loads[last] * np.exp(-1j * omega * time[last, None])).mean(axis=0)
    expected = -DATA.fit.response(np.array([omega]))[0, :, mode]
    scale = np.sqrt(np.abs(np.diag(DATA.fit.response(np.array([omega]))[0])))
    assert np.abs((found - expected) / (scale * scale[mode])).max() < 0.02


@compiled
@given(seed=st.integers(0, 9999))
def test_no_motion_gets_energy_out_of_the_memory(seed):
    rng = np.random.default_rng(seed)
    velocities = np.cumsum(rng.normal(size=(2000, 6)), axis=0) * [1.0, 1.0, 1.0, 0.1, 0.1, 0.1]
    work = np.einsum("ij,ij->i", follow(velocities, 0.02), velocities).cumsum()
    assert work[-1] < 1e-6 * np.abs(work).max()


def test_steady_motion_leaves_no_load():
    velocity = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
    loads = follow(np.tile(velocity, (20000, 1)), 0.02)
    assert np.abs(loads[-1]).max() < 1e-3 * np.abs(loads).max()
