"""A wire under a fixed or moving tip, for tests."""

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import wire_params
from shipcrane_twin.physics.payload import hanging_state, payload_step
from shipcrane_twin.physics.wire import wire_stiffness

WIRE = wire_params(load_scenario("case2"))
FIXED = np.array([1.0, -2.0, 12.0, 0.0, 0.0, 0.0])


def stiffness_at(length, wire=WIRE):
    return wire_stiffness(wire.elastic_modulus, wire.diameter, wire.fill_factor, length)


def swung_state(angle, length, mass, wire=WIRE):
    """Load at rest beside the fixed tip, the wire stretched by its pull at that angle."""
    state = hanging_state(wire, FIXED[:3], np.zeros(3), length, mass)
    reach = length + mass * wire.gravity * np.cos(angle) / stiffness_at(length, wire)
    state[:3] = FIXED[:3] + reach * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    return state


def swing(state, step_s, count, wire=WIRE, command=0.0):
    """States at the start and after each of `count` macro steps under the fixed tip."""
    states = [state]
    for _ in range(count):
        states.append(payload_step(wire, states[-1], command, FIXED, FIXED, step_s)[0])
    return np.array(states)


def energies(states, wire=WIRE):
    """Kinetic and total energy of each state under the fixed tip."""
    mass, length = states[:, 8], states[:, 6]
    kinetic = 0.5 * mass * np.sum(states[:, 3:6] ** 2, axis=1)
    stretch = np.maximum(0.0, np.linalg.norm(states[:, :3] - FIXED[:3], axis=1) - length)
    elastic = 0.5 * stiffness_at(length, wire) * stretch**2
    return kinetic, kinetic + elastic + mass * wire.gravity * (states[:, 2] - FIXED[2])
