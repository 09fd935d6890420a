"""Station keeping: how well the ship is held, how much the waves show in the thrust, how well the observer sees."""

from typing import NamedTuple

import numpy as np
from scipy import signal

from shipcrane_twin.cosim import dp_build
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.validation.positioning import AXES, Ride, during, off_setpoint, rms, slow, to_level

NO_FILTER = ("dp.observer.kind=none",)
UNBIASED = ("dp.sensors.position.bias_std_m=0.0",)
"""A position reference without drift, which no observer can tell from motion."""

BAND_HZ = (0.06, 0.2)
SEGMENT_S = 100.0
STEADY_S, SETTLED_S = 250.0, 200.0
CONVERGED_S = 100.0
BIAS_HZ = 0.02
"""Below it the load on the ship is what the bias estimate should be."""

FILTER_END_S = 15.0
"""Left out at the end of a record, where a filter without delay has nothing to look ahead to."""


class Bars(NamedTuple):
    """Bars of station keeping in one weather; None for what is told only."""

    position_rms: float
    heading_rms: float
    position_settled: float | None
    heading_settled: float | None


BARS = {
    "calm": Bars(0.5, 1.0, 1.0, 2.0),
    "E1": Bars(0.5, 1.0, 1.0, 2.0),
    "E2": Bars(1.0, 2.0, 2.5, None),
}


def station_rows(weather: str, run: Ride) -> list[Row]:
    """Return how far the CoG and the heading are off the set-point, RMS from 250 s on and at most from 200 s on."""
    bars = BARS[weather]
    distance, heading = off_setpoint(run)
    steady, settled = during(run, STEADY_S), during(run, SETTLED_S)
    beyond = np.flatnonzero((distance > 1.0) | (np.abs(heading) > 2.0))
    quiet = f"within 1 m and 2 deg from {run.time_s[beyond[-1]]:.0f} s on" if len(beyond) else "always within"
    far = f"{distance[during(run, run.scenario.dp.enabled_at_s)].max():.1f} m off at most before"
    return [
        Row(f"{weather}: position, RMS from 250 s on", rms(distance[steady]), bars.position_rms, "m"),
        Row(f"{weather}: heading, RMS from 250 s on", rms(heading[steady]), bars.heading_rms, "deg"),
        Row(f"{weather}: position, largest from 200 s on", distance[settled].max(), bars.position_settled, "m", far),
        Row(
            f"{weather}: heading, largest from 200 s on", np.abs(heading[settled]).max(), bars.heading_settled, "deg",
            quiet,
        ),
    ]  # fmt: skip


def spectra(run: Ride, values: Array) -> tuple[Array, Array]:
    """Return frequencies (m,) [Hz] and one-sided densities (m, k) of columns from 200 s on (Welch 1967)."""
    part = values[during(run, SETTLED_S)]
    length = min(round(SEGMENT_S / run.step_s), len(part))
    hz, density = signal.welch(part, fs=1.0 / run.step_s, nperseg=length, axis=0)
    return hz, density


def band_power(run: Ride, values: Array) -> Array:
    """Return the power (k,) of columns between 0.06 and 0.2 Hz."""
    hz, density = spectra(run, values)
    inside = (hz >= BAND_HZ[0]) & (hz <= BAND_HZ[1])
    return np.asarray(density[inside].sum(axis=0) * hz[1])


def wave_rows(weather: str, filtered: Ride, unfiltered: Ride) -> list[Row]:
    """Compare what DP asks for at the waves' frequencies with and without the wave filter; the same for the thrust."""
    rows = []
    for judged, what in ((True, "demand"), (False, "thrust given")):
        runs = [(run, run.demand if judged else run.known) for run in (filtered, unfiltered)]
        power = [band_power(*pair) for pair in runs]
        for i, axis in enumerate(AXES):
            unit = "kN m" if axis == "yaw" else "kN"
            size = " against ".join(f"{np.sqrt(of[i]) / 1e3:.2g}" for of in power)
            name = f"{weather}: {axis}, {what}, wave-frequency power with over without filter"
            rows.append(Row(name, power[0][i] / power[1][i], 0.10 if judged else None, "", f"RMS {size} {unit}"))
        force = power[0][:2].sum() / power[1][:2].sum()
        rows.append(Row(f"{weather}: force, {what}, wave-frequency power with over without filter", force, 0.10, ""))
    return rows


def observer_error(run: Ride) -> Array:
    """Return estimated pose minus the slow true one (n, 3)."""
    return run.estimate - slow(run.pose, run.step_s)


def true_bias(run: Ride) -> Array:
    """Return the load (n, 3) that the observer's ship needs to move as the true one does slowly, less what it knows.

    ``M nu' + D nu - tau``, level axes, below 0.02 Hz; `M` and `D` are the observer's.
    """
    mass, damping = dp_build.ship_3dof(run.scenario)
    pose = slow(run.pose, run.step_s)
    velocity = np.gradient(pose, run.step_s, axis=0)
    yaw = pose[:, 2]
    moved = to_level(np.gradient(velocity, run.step_s, axis=0), yaw) @ mass.T + to_level(velocity, yaw) @ damping.T
    return slow(moved - run.known, run.step_s, BIAS_HZ)


def observer_rows(weather: str, run: Ride) -> list[Row]:
    """Return the errors of position and bias in a run whose position reference does not drift."""
    end = run.time_s[-1] - FILTER_END_S
    error = observer_error(run)[during(run, SETTLED_S, end)]
    east, north = (rms(error[:, i]) for i in range(2))
    noise = run.scenario.dp.sensors.position.noise_std_m
    from_s = run.scenario.dp.enabled_at_s + CONVERGED_S
    later = during(run, from_s, end)
    truth = true_bias(run)
    load = truth[later].mean(axis=0)
    off = run.bias[later].mean(axis=0) - load
    force = float(np.hypot(*off[:2]) / np.hypot(*load[:2]))
    told = f"{np.hypot(*load[:2]) / 1e3:.1f} kN"
    return [
        Row(
            f"{weather}: observer, slow position, RMS from 200 s on, the worse of two axes", max(east, north), 0.1, "m",
            f"east {east:.3f}, north {north:.3f} m; noise {noise:g} m",
        ),
        Row(f"{weather}: observer, slow heading, RMS from 200 s on", float(np.rad2deg(rms(error[:, 2]))), 0.2, "deg"),
        Row(f"{weather}: bias, force, mean error from 100 s after switch-on", force, 0.10, "", f"of {told}"),
        Row(
            f"{weather}: bias, moment, mean error from 100 s after switch-on", abs(off[2] / load[2]), 0.10, "",
            f"of {abs(load[2]) / 1e3:.0f} kN m",
        ),
        Row(
            f"{weather}: time after switch-on until the bias force stays within 20 %", settling(run, truth),
            CONVERGED_S, "s",
        ),
    ]  # fmt: skip


def settling(run: Ride, truth: Array, share: float = 0.2) -> float:
    """Return how long after switch-on the slow part of the bias force comes within a share of the mean load [s]."""
    on = run.scenario.dp.enabled_at_s
    size = np.hypot(*truth[during(run, on + CONVERGED_S)].mean(axis=0)[:2])
    off = slow(run.bias, run.step_s, BIAS_HZ) - truth
    beyond = np.flatnonzero(np.hypot(off[:, 0], off[:, 1]) > share * size)
    beyond = beyond[run.time_s[beyond] < run.time_s[-1] - FILTER_END_S]
    return float(run.time_s[beyond[-1]] - on) if len(beyond) else 0.0
