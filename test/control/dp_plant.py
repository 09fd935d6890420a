"""A ship of Gunnerus' size in the horizontal plane with slow and wave-frequency motion, and observers for it."""

import numpy as np

from shipcrane_twin.control.ekf import ekf_params, ekf_start, ekf_step
from shipcrane_twin.control.observer import passive_params, passive_start, passive_step

MASS = np.array([[5.06e5, 0.0, 0.0], [0.0, 6.44e5, -3.8e5], [0.0, -3.8e5, 3.6e7]])
DAMPING = np.array([[5.0e3, 0.0, 0.0], [0.0, 1.0e4, 1.0e4], [0.0, 1.0e4, 4.0e5]])
DT = 0.1
PEAK = 2.0 * np.pi / 10.0
NONE = np.full(3, np.nan)
GYRO_STD = np.deg2rad(0.1)
BIAS_W = np.array([8.0e3, -6.0e3, 4.0e4])
ONE = np.ones(3)

COMMON = {
    "wave_frequency": PEAK * ONE,
    "wave_damping": 0.1 * ONE,
    "bias_time_constant_s": 1.0e4 * ONE,
    "lost_after_s": 5.0,
    "return_s": 30.0,
}
PASSIVE = {
    "notch_damping": 0.7 * ONE,
    "cutoff_ratio": 1.22 * ONE,
    "bias_period_s": 100.0 * ONE,
    "bias_damping": ONE,
    "sample_period_s": DT * ONE,
}
EKF = {
    "wave_std": np.array([0.3, 0.3, 0.01]),
    "measurement_std": np.array([0.5, 0.5, GYRO_STD]),
    "load_noise": np.array([500.0, 500.0, 5.0e3]),
    "bias_walk": np.array([100.0, 100.0, 1.0e3]),
    "velocity_start_std": np.array([0.2, 0.2, 0.01]),
    "bias_start_std": np.array([1.0e4, 1.0e4, 1.0e5]),
}


def passive(**changes):
    return passive_params(MASS, DAMPING, changes.pop("period", DT), **(COMMON | PASSIVE | changes))


def ekf(**changes):
    return ekf_params(MASS, DAMPING, changes.pop("period", DT), **(COMMON | EKF | changes))


OBSERVERS = {"passive": (passive, passive_start, passive_step), "ekf": (ekf, ekf_start, ekf_step)}


def turn(yaw):
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def ship_path(seconds, known_load, bias_w=BIAS_W, start=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), hold=True):
    """Slow motion by classical Runge-Kutta: states (n + 1, 6) and known loads (n, 3), held over each period.

    ``hold`` adds a spring, a damper and the counter of the bias to the known load, as a DP would.
    """
    inverse = np.linalg.inv(MASS)

    def rate(x, load):
        rot = turn(x[2])
        return np.concatenate((rot @ x[3:], inverse @ (load + rot.T @ bias_w - DAMPING @ x[3:])))

    x = np.array(start, dtype=float)
    path, loads = [x], []
    for k in range(round(seconds / DT)):
        load = np.array(known_load(k * DT), dtype=float)
        if hold:
            rot = turn(x[2])
            load -= rot.T @ (bias_w + [5e3, 5e3, 3e5] * x[:3]) + [7e4, 7e4, 5e6] * x[3:]
        k1 = rate(x, load)
        k2 = rate(x + 0.5 * DT * k1, load)
        k3 = rate(x + 0.5 * DT * k2, load)
        k4 = rate(x + DT * k3, load)
        x = x + DT / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        path.append(x)
        loads.append(load)
    return np.array(path), np.array(loads)


def slow_loads(t):
    return [4e3 * np.sin(0.03 * t), 3e3 * np.cos(0.02 * t), 3e4 * np.sin(0.025 * t)]


def jonswap(seconds, std, seed, peak=PEAK):
    """A Gaussian record (n + 1,) of a JONSWAP spectrum with peak enhancement 3.3 and this standard deviation."""
    rng = np.random.default_rng(seed)
    omega = np.linspace(0.5, 3.0, 200) * peak
    omega = omega + rng.uniform(-0.5, 0.5, 200) * (omega[1] - omega[0])
    width = np.where(omega <= peak, 0.07, 0.09)
    density = omega**-5.0 * np.exp(-1.25 * (peak / omega) ** 4)
    density *= 3.3 ** np.exp(-0.5 * ((omega / peak - 1.0) / width) ** 2)
    size = std * np.sqrt(2.0 * density / density.sum())
    t = np.arange(round(seconds / DT) + 1) * DT
    return np.cos(t[:, None] * omega + rng.uniform(0.0, 2.0 * np.pi, 200)) @ size


def wave_motion(seconds, std, seed=3, peak=PEAK):
    return np.column_stack([jonswap(seconds, size, seed + i, peak) for i, size in enumerate(std)])


def measure(path, waves, noise_std, every=1, seed=11):
    """Measured poses (n + 1, 3): the position at every so many updates, the heading at all."""
    noise = np.random.default_rng(seed).standard_normal((path.shape[0], 3))
    out = path[:, :3] + waves + noise * noise_std
    out[np.arange(out.shape[0]) % every > 0, :2] = np.nan
    return out


def observe(step, params, state, measured, loads, wave_frequency=NONE):
    """States (n + 1, m): the first as given, then one for each load with the measurement after it."""
    states = [state]
    for load, pose in zip(loads, measured[1:], strict=True):
        states.append(step(params, states[-1], pose, load, wave_frequency))
    return np.array(states)


def band_power(series, low_hz=0.06, high_hz=0.2):
    """Power of columns in a band of frequencies, Hann window."""
    centred = (series - series.mean(axis=0)) * np.hanning(series.shape[0])[:, None]
    hz = np.fft.rfftfreq(series.shape[0], DT)
    power = np.abs(np.fft.rfft(centred, axis=0)) ** 2
    return power[(hz >= low_hz) & (hz <= high_hz)].sum(axis=0)
