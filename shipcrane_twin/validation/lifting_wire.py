"""The load on its wire by itself: spherical pendulum, sway amplification, snap."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import wire_params
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.payload import WireParams, hanging_state, payload_step
from shipcrane_twin.physics.winch import Hold
from shipcrane_twin.physics.wire import wire_stiffness

WIRE = wire_params(load_scenario("case2"))
"""The wire of the scenarios."""

FIXED = np.array([1.0, -2.0, 12.0, 0.0, 0.0, 0.0])
FAST = Hold(pull=np.inf, mass=1e3, leak=0.0, sheave_friction=0.0, length_min=0.0, length_end=np.inf)
"""A tip that rests, and a drum that holds any pull."""

SNAP_MAX = 12
"""Column of the largest snap in the load's state."""

LOAD_KG = 700.0
PENDULUM_BAR_M, SWAY_BAR, SNAP_BAR = 1e-4, 0.02, 0.02
SHARES = (0.2, 0.5, 0.7, 1.4, 2.0, 4.0)
"""Frequencies of the pivot over the natural one."""

DROPS = ((1.0, 700.0, 0.05), (20.0, 2200.0, 0.3), (100.0, 50.0, 1.0))
"""Length of wire [m], mass [kg], height of the fall [m]."""


def stiffness_at(length: float, wire: WireParams = WIRE) -> float:
    """Return the stiffness of so much wire [N/m]."""
    return wire_stiffness(wire.elastic_modulus, wire.diameter, wire.fill_factor, length)


def held_step(
    wire: WireParams, state: Array, tip_prev: Array, tip_next: Array, step_s: float, rate: float = 0.0
) -> tuple[Array, Array, float]:
    """Return state, force on the tip and tension after a macro step, the drum told to go on at a rate [m/s]."""
    state = state.copy()
    state[7] = rate
    return payload_step(wire, FAST, state, rate, rate, tip_prev, tip_next, step_s)


def swing(state: Array, step_s: float, count: int, wire: WireParams = WIRE) -> Array:
    """Return the states (count + 1, 14) of a load under the fixed tip, the drum still."""
    states = [state]
    for _ in range(count):
        states.append(held_step(wire, states[-1], FIXED, FIXED, step_s)[0])
    return np.array(states)


class SwayingTip:
    """A tip that moves harmonically along each axis, the motion growing from rest over a time [s]."""

    def __init__(self, amplitude: tuple[float, ...], rate: tuple[float, ...], ramp: float = 1e-9) -> None:
        self.amplitude, self.rate, self.ramp = np.array(amplitude), np.array(rate), ramp

    def at(self, t: float) -> Array:
        """Return position and velocity (6,) at a time [s]."""
        share = 1.0 - np.exp(-t / self.ramp)
        growth = np.exp(-t / self.ramp) / self.ramp
        place, speed = self.amplitude * np.sin(self.rate * t), self.amplitude * self.rate * np.cos(self.rate * t)
        return np.concatenate((FIXED[:3] + share * place, share * speed + growth * place))


def rigid_pendulum(tip: SwayingTip, start: Array, times: Array) -> Array:
    """Return the path (n, 3) of a point mass on a rod without mass: constraint force, Dormand-Prince of order 8."""

    def pivot_accel(t: float) -> Array:
        return (tip.at(t + 1e-4)[3:] - tip.at(t - 1e-4)[3:]) / 2e-4 if t > 1e-4 else np.zeros(3)

    def rate(t: float, y: Array) -> Array:
        r, v = y[:3], y[3:]
        free = -pivot_accel(t) - [0.0, 0.0, WIRE.gravity]
        return np.concatenate((v, free - (r @ free + v @ v) / (r @ r) * r))

    solved = solve_ivp(rate, (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-12).y.T
    return np.asarray(solved[:, :3] + np.array([tip.at(t)[:3] for t in times]))


class Paths(NamedTuple):
    """Times (n,), and the load's path (n, 3) by the kernel and by the rigid pendulum."""

    time_s: Array
    ours: Array
    exact: Array

    @property
    def error_m(self) -> float:
        """Largest distance [m]."""
        return float(np.linalg.norm(self.ours - self.exact, axis=1).max())


def pendulum(step_s: float) -> Paths:
    """Return a minute under a pivot that moves in three directions, from 0.3 rad, the wire a thousandfold stiff."""
    tip, length = SwayingTip((0.3, 0.2, 0.1), (0.9, 0.7, 0.5), ramp=2.0), 6.0
    times = np.arange(0.0, 60.0 + 1e-9, step_s)
    stiff = WIRE._replace(elastic_modulus=1e3 * WIRE.elastic_modulus)
    state = hanging_state(stiff, FIXED[:3], np.zeros(3), length, LOAD_KG)
    reach = FIXED[2] - state[2]
    state[:3] = FIXED[:3] + reach * np.array([np.sin(0.3), 0.0, -np.cos(0.3)])
    exact = rigid_pendulum(tip, np.concatenate((state[:3] - FIXED[:3], state[3:6])), times)
    path = [state]
    for t in times[:-1]:
        path.append(held_step(stiff, path[-1], tip.at(t), tip.at(t + step_s), step_s)[0])
    return Paths(times, np.array(path)[:, :3], exact)


def sway_gain(share: float, length: float = 10.0, step_s: float = 0.05) -> tuple[complex, float]:
    """Return load over pivot motion at a share of the natural frequency, and ``1 / (1 - share^2)``.

    The load starts on its steady path, so that no free swing hides it.
    """
    rate = share * np.sqrt(WIRE.gravity / length)
    amplitude = 0.02 / max(1.0, share)
    gain = 1.0 / (1.0 - share**2)
    tip = SwayingTip((amplitude, 0.0, 0.0), (rate, 0.0, 0.0))
    state = hanging_state(WIRE, FIXED[:3], np.zeros(3), length, LOAD_KG)
    state[3] = amplitude * gain * rate
    path = []
    for k in range(round(6.0 * np.pi / rate / step_s)):
        t = k * step_s
        state = held_step(WIRE, state, tip.at(t), tip.at(t + step_s), step_s)[0]
        path.append(state[0] - FIXED[0])
    times = step_s * (1.0 + np.arange(len(path)))
    columns = np.column_stack((np.sin(rate * times), np.cos(rate * times)))
    in_phase, across = np.linalg.lstsq(columns, np.array(path), rcond=None)[0]
    return complex(in_phase, across) / amplitude, gain


def falls(height: float, length: float, mass: float, wire: WireParams, step_s: float, seconds: float) -> Array:
    """Return the states (n, 14) of a load that falls from a height [m] above where the wire goes taut."""
    state = hanging_state(wire, FIXED[:3], np.zeros(3), length, mass)
    state[2] = FIXED[2] - length + height
    return swing(state, step_s, round(seconds / step_s), wire)


def snap_tension(height: float, length: float, mass: float) -> float:
    """Return the peak ``m g + sqrt((m g)^2 + 2 k m g h)`` [N] of a mass that falls onto an elastic wire."""
    weight = mass * WIRE.gravity
    return float(weight + np.sqrt(weight**2 + 2.0 * stiffness_at(length) * weight * height))


def snap_error(height: float, length: float, mass: float, step_s: float) -> float:
    """Return how far the reported snap is from the closed form, relative; the wire without damping."""
    last = falls(height, length, mass, WIRE._replace(damping_ratio=0.0), step_s, 1.2)[-1]
    return float(abs(last[SNAP_MAX] / snap_tension(height, length, mass) - 1.0))


def wire_rows(steps_s: tuple[float, ...] = (0.02, 0.1)) -> list[Row]:
    """Return pendulum, sway amplification and snap against independent solutions."""
    rows = [
        Row(
            f"spherical pendulum, moving pivot, 60 s, macro step {1e3 * h:g} ms", pendulum(h).error_m, PENDULUM_BAR_M,
            "m",
        )
        for h in steps_s
    ]  # fmt: skip
    for share in SHARES:
        found, exact = sway_gain(share)
        what = f"sway over pivot motion at {share:g} of the natural frequency, with phase error"
        rows.append(Row(what, abs(found / exact - 1.0), SWAY_BAR, "", f"{abs(found):.3f} times the pivot's"))
    for length, mass, height in DROPS:
        error = max(snap_error(height, length, mass, h) for h in (0.001, 0.02, 0.2))
        what = f"snap, {mass:g} kg falls {height:g} m onto {length:g} m of wire, worst of macro steps 1, 20 and 200 ms"
        rows.append(Row(what, error, SNAP_BAR, "", f"{snap_tension(height, length, mass) / 1e3:.1f} kN"))
    return rows
