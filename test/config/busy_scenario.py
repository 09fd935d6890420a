"""A short scenario in which every part acts, and stages in which limits and single table rows do."""

import copy

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.settings import plain
from shipcrane_twin.control.load_limiter import radius_and_slopes, safe_working_load
from shipcrane_twin.cosim.build import crane_chain, crane_drives, load_limiter
from shipcrane_twin.physics.crane_cylinders import joints_from_lengths

MOVES = {
    "slew": {"velocity_rad_s": 0.005},
    "boom": {"velocity_rad_s": 0.005},
    "knuckle": {"velocity_rad_s": 0.005},
    "telescope": {"velocity_m_s": 0.02},
    "winch": {"velocity_m_s": 0.05},
}

SEA = [
    {"spectrum": "regular", "direction_to_deg": 40.0, "height_m": 0.3, "period_s": 9.0},
    {
        "spectrum": "jonswap",
        "direction_to_deg": 130.0,
        "significant_wave_height_m": 1.0,
        "peak_period_s": 6.0,
        "peak_enhancement": 2.0,
        "spreading_exponent": 8.0,
    },
    {
        "spectrum": "torsethaugen",
        "direction_to_deg": -60.0,
        "significant_wave_height_m": 0.8,
        "peak_period_s": 7.0,
    },
]


def put(data, path, value):
    """Set one value in nested data, in place."""
    for key in path[:-1]:
        data = data[key]
    data[path[-1]] = value


def look(data, path):
    """Return the value at a path of nested data."""
    for key in path:
        data = data[key]
    return data


def busy():
    """Eight tenths of a second with DP, weather, all joints and the winch at work, and a release."""
    data = plain(load_scenario("case2"))
    data["duration_s"] = 0.8
    data["environment"] = {
        "water_depth_m": 30.0,
        "waves": {
            "systems": copy.deepcopy(SEA),
            "ramp_s": 1.0,
            "kurtosis_error": 0.02,
            "slow_motion_period_s": 2.0,
            "first_order": True,
            "slow_drift": True,
        },
        "current_speed_m_s": 0.5,
        "current_direction_to_deg": 33.0,
        "current_deviation_m_s": 0.1,
        "current_time_constant_s": 50.0,
        "current_profile": [[0.0, 1.0], [2.0, 0.8], [10.0, 0.5]],
        "wind_speed_m_s": 7.0,
        "wind_direction_to_deg": 71.0,
        "wind_gusts": "froya",
    }
    data["vessel"]["ballast"] = {"mode": "values", "heave_n": 1e3, "roll_n_m": 2e4, "pitch_n_m": 3e4}
    dp = data["dp"]
    dp["enabled_at_s"] = 0.0
    dp["period_ms"] = 20.0
    dp["sensors"]["gyro"]["bias_std_deg"] = 0.05
    for sensor in ("position", "gyro", "mru", "wind"):
        dp["sensors"][sensor]["period_ms"] = 40.0
        dp["sensors"][sensor]["delay_samples"] = 1
    dp["observer"] |= {"lost_after_s": 0.1, "return_s": 0.2}
    dp["controller"]["crane_share"] = 0.5
    dp["allocation"]["hold_thrust_n"] = 537.0  # just below what the azimuths give at first
    dp["setpoints"] = [{"at_s": 0.3, "north_m": 2.0, "east_m": -1.0, "heading_deg": 12.0}]
    data["dp"]["setpoint"] = {"north_m": 1.0, "east_m": -2.0, "heading_deg": 10.0}
    data["operations"] = [
        {"label": joint, "joint": joint, "from_s": 0.1, "to_s": 0.6, **speed} for joint, speed in MOVES.items()
    ]
    data["events"] = [
        {"label": "drop", "at_s": 0.4, "event": "release_payload"},
        {"label": "weak", "at_s": 0.3, "event": "thruster_fault", "which": "bow_tunnel", "fault": "limited"}
        | {"share": 0.4},
        {"label": "blackout", "at_s": 0.5, "event": "power_limit", "share": 0.001},
        {"label": "no fix", "at_s": 0.1, "event": "sensor_fault", "which": "position", "fault": "drop_out"},
        {"label": "fix", "at_s": 0.4, "event": "sensor_fault", "which": "position", "fault": "none"},
    ]
    for i in range(6):  # so that every pair of modes may be coupled by damping
        data["vessel"]["hull"]["viscous_damping_frd"][i][i] += 1e4
    return data


def weak():
    """Drives too weak for what is asked of them, and a controller that may hardly ask."""
    data = busy()
    for link, limit in zip(data["crane"]["links"], (50.0, 1e6, 1e6, 1e5), strict=True):
        link["drive"]["torque_max_n_m" if link["drive"]["kind"] == "motor" else "pressure_max_pa"] = limit
    data["dp"]["controller"]["load_max"] = [1.0, 1.0, 10.0]
    winch = data["winch"]
    winch["length_max_m"] = 80.0
    # motor and brake hold less than the load; 5 cm more wire on the drum than two layers take
    winch["drum"] |= {"motor_torque_n_m": 15.0, "brake_torque_n_m": 1.5e3, "wire_length_m": 83.48}
    return data


def without_power(event):
    """The winch loses its motor."""
    data = busy()
    data["events"] = [{"label": "fault", "at_s": 0.2, "event": event}]
    return data


def failing(event, share=1.0):
    """All drives lose their power at work; their brakes have a share of their force."""
    data = busy()
    data["events"].append({"label": "power", "at_s": 0.3, "event": event})
    for link in data["crane"]["links"]:
        key = "brake_torque_n_m" if link["drive"]["kind"] == "motor" else "holding_pressure_pa"
        link["drive"][key] *= share
    return data


def overloaded(row):
    """A load that the limiter just cuts out, at a radius between a row of the load chart and a neighbour."""
    data = busy()
    chart = data["crane"]["load_chart"]
    first = min(row, len(chart) - 2)
    radius = np.mean(chart[first : first + 2], axis=0)[0]
    scenario = load_scenario("case2")
    chain, q = crane_chain(scenario.crane), np.array(scenario.crane.initial_joints)
    if first < 2:  # near the pedestal, with the booms up
        q[1:3] = 0.8, 0.2
    where = np.linspace(0.0, 10.0, 400)
    radii = [radius_and_slopes(chain, np.array([*q[:3], x]))[0] for x in where]
    q[3] = where[np.argmin(np.abs(np.array(radii) - radius))]
    data["crane"]["initial_joints"] = q.tolist()
    limiter = load_limiter(scenario)
    load = 1.1 * safe_working_load(limiter, radius_and_slopes(chain, q)[0])
    data["payload"]["mass_kg"] = float(load * 0.9995)
    return data


def relieved():
    """A load that the limiter cuts out, and that is gone before the crane has stood for long."""
    data = overloaded(3)
    data["payload"]["mass_kg"] *= 1.01
    data["crane"]["load_limiter"]["filter_s"] = 3.0
    data["events"][0]["at_s"] = 0.1
    for move in data["operations"]:
        move["to_s"] = 0.8
    return data


def tucked():
    """The load hangs inboard of the main boom, so that its cylinder pulls, with little pressure."""
    data = at_ends(-1)
    data["crane"]["initial_joints"][3] = 8.0
    data["crane"]["links"][1]["drive"]["pressure_max_pa"] = 1e4
    return data


def slow():
    """Drives and a reference at their greatest speed, and thrusters at their greatest push."""
    data = busy()
    for link in data["crane"]["links"]:
        key = "speed_max_rad_s" if "speed_max_rad_s" in link["drive"] else "speed_max_m_s"
        link["drive"][key] = 0.001
    for thruster in data["vessel"]["thrusters"]:
        thruster["thrust_max_n"] = 1.0
        thruster["power_max_kw"] = 0.01
    data["winch"]["speed_max_m_s"] = 0.02
    data["dp"]["reference"] |= {"speed_max_m_s": 0.002, "turn_max_deg_s": 0.005}
    return data


def at_ends(sign):
    """All cylinders and the wire a little before an end (1 long, -1 short), and on their way to it."""
    data = busy()
    drives = crane_drives(load_scenario("case2").crane)
    length = drives.length_max if sign > 0 else drives.length_min
    places = joints_from_lengths(drives, length - sign * 0.0102)
    data["crane"]["initial_joints"] = [data["crane"]["initial_joints"][0], *map(float, places[1:])]
    for move in data["operations"]:
        for key in ("velocity_rad_s", "velocity_m_s"):
            if key in move:
                move[key] *= sign * 10.0
    winch = data["winch"]
    winch["initial_length_m"] = winch["length_max_m"] - 0.01 if sign > 0 else winch["length_min_m"] + 0.01
    return data


def flow_along_row(path, data):
    """Turn wind or current to the direction of the table row that a path leads to."""
    angle = look(data, [*path[:-1], 0])
    data = copy.deepcopy(data)
    data["environment"]["waves"]["systems"] = []  # the ship stays on its heading
    if "wind_areas" in path:
        data["environment"]["wind_direction_to_deg"] = angle + 180.0
        data["environment"]["wind_gusts"] = "none"
    else:
        data["environment"]["current_deviation_m_s"] = 0.0
        data["environment"]["current_direction_to_deg"] = angle
    return data


def hungry():
    """Thrusters with less power than they want, which fail in the end; a heading soon reached; DP goes off."""
    data = busy()
    data["vessel"]["power_total_max_kw"] = 0.01
    data["environment"]["current_direction_to_deg"] = 213.0  # the propellers' inflow comes from ahead
    data["dp"]["reference"] |= {"turn_max_deg_s": 10.0, "turn_accel_max_deg_s2": 10.0}
    data["dp"]["setpoint"]["heading_deg"] = 0.3
    data["dp"]["setpoints"][0]["heading_deg"] = 0.5
    data["events"][1]["share"] = 0.0
    data["events"].append({"label": "off", "at_s": 0.6, "event": "dp_off"})
    for thruster in data["vessel"]["thrusters"]:
        failed = {"label": "lost", "at_s": 0.7, "event": "thruster_fault", "which": thruster["name"], "fault": "failed"}
        data["events"].append(failed)
    return data


def filtered():
    """The Kalman filter, a heading that follows the weather, thrusters that turn fast."""
    data = busy()
    data["dp"]["observer"]["kind"] = "ekf"
    data["dp"]["weathervane"]["enabled"] = True
    data["dp"]["controller"]["fade_s"] = 1.0
    return data
