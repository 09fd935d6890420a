"""Thrust allocation: what can be given is given, limits and zones are kept, the rest is the best there is."""

import time

import numpy as np
import pytest
from gunnerus_thrusters import AZIMUTHING, POSITION, THRUST, WHOLE, in_zone, load_of, random_thrust, thrusters
from scipy.optimize import linprog

from shipcrane_twin.control.allocation import allocate, allocation_start, horizontal_load
from shipcrane_twin.control.allocation_program import pseudo_inverse, static_thrust
from shipcrane_twin.control.allocation_setup import METHODS, opposing_bias

YAW_FIRST, POSITION_FIRST = thrusters(), thrusters(yaw_first=False)
SCALE = YAW_FIRST.load_scale
FRESH = np.full(3, -1.0)
AHEAD = np.array([0.0, 0.0, np.pi / 2])
RANGE = np.array([80e3, 60e3, 8e5])


def in_newtons(params, parts):
    """Thrust components (3, 2) [N] of the unknowns of the program; the tunnel pushes along its axis."""
    thrust = parts.reshape(3, 2) * THRUST[:, None]
    thrust[2] = 0.0, thrust[2, 0]
    return thrust


def static(params, load, share=WHOLE):
    return in_newtons(params, static_thrust(params, load, share, FRESH)[0])


def power(params, thrust):
    return params.power_share @ (np.linalg.norm(thrust, axis=-1) / THRUST) ** 2


def assert_within_limits(thrust, share=WHOLE):
    size = np.linalg.norm(thrust, axis=1)
    assert np.all(size <= share * THRUST * (1.0 + 1e-9) + 1e-6)
    pushing = size[:2] > 1e-3
    assert not np.any(in_zone(np.arctan2(thrust[:2, 1], thrust[:2, 0]))[pushing])


def follow(params, state, loads, share=WHOLE, measured=None):
    """States (k + 1, 3, 4) and achieved loads (k, 3) along demands (k, 3)."""
    states, achieved = [state], []
    for load in loads:
        state, got = allocate(params, state, load, state[:, 0] if measured is None else measured, share)
        states.append(state)
        achieved.append(got)
    return np.array(states), np.array(achieved)


def turns(states):
    return (np.diff(states[:, :, 0], axis=0) + np.pi) % (2.0 * np.pi) - np.pi


def assert_rates_kept(params, states):
    assert np.all(np.abs(turns(states)) <= params.azimuth_step * (1.0 + 1e-9))
    change = np.abs(np.diff(states[:, :, 1], axis=0))
    assert np.all(change <= params.thrust_step * (1.0 + 1e-9))


@pytest.mark.parametrize("params", [YAW_FIRST, POSITION_FIRST], ids=["yaw first", "position first"])
def test_of_10000_random_demands_those_that_can_be_given_are_given(params, measured):
    static(params, RANGE)  # compiles
    rng = np.random.default_rng(2019)
    worst, longest = 0.0, 0.0
    for load in load_of(random_thrust(rng, 5000)):
        started = time.perf_counter()
        parts = static_thrust(params, load, WHOLE, FRESH)[0]
        longest = max(longest, time.perf_counter() - started)
        thrust = in_newtons(params, parts)
        assert_within_limits(thrust)
        worst = max(worst, np.abs((load_of(thrust) - load) / SCALE).max())
    for load in rng.uniform(-1.0, 1.0, (5000, 3)) * RANGE * rng.uniform(0.5, 3.0, (5000, 1)):
        assert_within_limits(static(params, load))
    first = "yaw" if params is YAW_FIRST else "position"
    measured(f"allocation, {first} first: feasible demands of 10,000, missed part of full load", worst, 1e-6)
    measured(f"allocation, {first} first: worst of 5000 solves, four programs each", 1e3 * longest, 1e3, "ms")


def corner_loads():
    """Loads over SCALE of corners of each convex piece of the thrust that the stern azimuths may give, tunnel too."""
    angles = np.arange(32) * 2.0 * np.pi / 32
    ring = np.column_stack((np.cos(angles), np.sin(angles)))
    edges = [np.deg2rad([110.0, 290.0]), np.deg2rad([250.0, 430.0])]
    out = []
    for a, b in [(a, b) for a in edges for b in edges]:
        columns = []
        for i, (low, high) in enumerate((a, -b[::-1])):
            middle = 0.5 * (low + high)
            side = ring @ [np.cos(middle), np.sin(middle)]
            points = np.vstack((ring[side > 1e-9], chord_ends(low, high), np.zeros(2)))
            thrust = np.zeros((len(points), 3, 2))
            thrust[:, i] = points * 54e3
            columns.append(load_of(thrust) / SCALE)
        thrust = np.zeros((2, 3, 2))
        thrust[:, 2, 1] = -20e3, 20e3
        columns.append(load_of(thrust) / SCALE)
        out.append(columns)
    return out


def chord_ends(low, high):
    """Where the rays at two azimuths leave the polygon of 32 sides."""
    out = []
    for angle in (low, high):
        from_middle = (angle + np.pi / 32) % (np.pi / 16) - np.pi / 32
        off = np.pi / 32 - abs(from_middle)
        radius = np.cos(np.pi / 32) / np.cos(off)
        out.append(radius * np.array([np.cos(angle), np.sin(angle)]))
    return np.array(out)


def best_missing(columns, load, yaw_first):
    """Yaw, force across and force along that are missed at least, in this order or with yaw last: linear programs."""
    size = np.hypot(*load[:2])
    along, across = load[:2] / size, np.array([-load[1], load[0]]) / size
    effects, groups = np.hstack([c.T for c in columns]), []
    at = 0
    for c in columns:
        row = np.zeros(effects.shape[1])
        row[at : at + len(c)] = 1.0
        groups.append(row)
        at += len(c)
    axes = {"yaw": (effects[2], load[2]), "across": (across @ effects[:2], 0.0), "along": (along @ effects[:2], size)}
    equal, values = [np.append(g, 0.0) for g in groups], [1.0] * len(groups)
    bounds_rows, bounds_values, missing = [], [], []
    for name in ("yaw", "across", "along") if yaw_first else ("across", "along", "yaw"):
        row, goal = axes[name]
        ahead, behind = np.append(row, -1.0), np.append(-row, -1.0)
        cost = np.zeros(len(row) + 1)
        cost[-1] = 1.0
        result = linprog(
            cost, [*bounds_rows, ahead, behind], [*bounds_values, goal, -goal], equal, values, method="highs"
        )
        assert result.success
        missing.append(result.fun)
        bounds_rows += [np.append(row, 0.0), np.append(-row, 0.0)]
        bounds_values += [goal + result.fun + 1e-6, -goal + result.fun + 1e-6]
    return missing


@pytest.mark.parametrize("params", [YAW_FIRST, POSITION_FIRST], ids=["yaw first", "position first"])
def test_what_cannot_be_given_is_missed_least_in_the_order_of_priority(params):
    """Against the best of four lexicographic linear programs over the corners of the attainable thrust."""
    rng, yaw_first = np.random.default_rng(5), params is YAW_FIRST
    for load in rng.uniform(-1.0, 1.0, (40, 3)) * RANGE * 2.0:
        part = load / SCALE
        best = min(best_missing(columns, part, yaw_first) for columns in corner_loads())
        got = load_of(static(params, load)) / SCALE - part
        size = np.hypot(*part[:2])
        across, along = (part[0] * got[1] - part[1] * got[0]) / size, (part[:2] @ got[:2]) / size
        found = np.abs([got[2], across, along] if yaw_first else [across, along, got[2]])
        # squares at 1 to 1000: what comes first gives way by a thousandth of what comes next, times the slope
        assert np.all(np.abs(found - best)[:2] <= [2e-3, 1e-2])
        assert found[2] <= best[2] + 4e-2


def test_with_position_first_the_direction_of_the_force_is_kept_beyond_saturation(measured):
    rng, worst = np.random.default_rng(6), 0.0
    for load in rng.uniform(-1.0, 1.0, (300, 3)) * RANGE * 3.0:
        got = load_of(static(POSITION_FIRST, load))
        off = np.arctan2(load[0] * got[1] - load[1] * got[0], load[:2] @ got[:2])
        worst = max(worst, np.rad2deg(abs(off)))
    measured("allocation, infeasible demands, position first: direction of the force", worst, 0.2, "deg")


def test_random_thrust_never_does_better_than_the_program():
    rng = np.random.default_rng(8)
    others = random_thrust(rng, 200_000)
    effects = load_of(others) / SCALE
    for load in rng.uniform(-1.0, 1.0, (20, 3)) * RANGE * 1.5:
        got = load_of(static(YAW_FIRST, load)) / SCALE

        def cost(effect, part=load / SCALE):
            off, size = effect - part, np.hypot(*part[:2])
            along, across = off[..., :2] @ part[:2] / size, off[..., :2] @ [-part[1], part[0]] / size
            weights = YAW_FIRST.along_weight, YAW_FIRST.across_weight, YAW_FIRST.yaw_weight
            return weights[0] * along**2 + weights[1] * across**2 + weights[2] * off[..., 2] ** 2

        assert cost(got) <= cost(effects).min() + 2.0  # power itself costs up to one


def test_power_is_the_least_of_all_thrust_with_the_same_load():
    rng, null = np.random.default_rng(3), np.linalg.svd(YAW_FIRST.effect[:, :5])[2][3:].T
    for load in load_of(0.5 * random_thrust(rng, 100)):
        parts = static_thrust(YAW_FIRST, load, WHOLE, FRESH)[0]
        least = power(YAW_FIRST, in_newtons(YAW_FIRST, parts))
        for move in rng.normal(size=(30, 2)) * 0.05:
            other = parts.copy()
            other[:5] += null @ move
            thrust = in_newtons(YAW_FIRST, other)
            size = np.linalg.norm(thrust, axis=1)
            within = np.all(size <= THRUST * np.cos(np.pi / 32)) and not np.any(
                in_zone(np.arctan2(thrust[:2, 1], thrust[:2, 0]))
            )
            assert not within or power(YAW_FIRST, thrust) >= least - 1e-6


def test_power_grows_with_the_demand():
    rng = np.random.default_rng(4)
    for load in load_of(random_thrust(rng, 50)):
        uses = [power(YAW_FIRST, static(YAW_FIRST, part * load)) for part in np.linspace(0.0, 1.0, 21)]
        assert np.all(np.diff(uses) >= -1e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bias", [0.0, 3e3])
def test_rates_limits_and_zones_are_kept_along_random_demands(method, bias):
    rng, params = np.random.default_rng(11), thrusters(method, bias=bias)
    jumps = np.repeat(rng.uniform(-1.0, 1.0, (40, 3)) * RANGE * 1.5, 60, axis=0)
    states, _ = follow(params, allocation_start(params, AHEAD), jumps + rng.normal(size=jumps.shape) * 0.02 * RANGE)
    assert_rates_kept(params, states)
    assert not np.any(in_zone(states[:, :, 0]))
    assert np.all(np.abs(states[:, :, 1]) <= THRUST * (1.0 + 1e-9))
    assert np.all(states[:, :2, 1] >= 0.0)
    np.testing.assert_array_equal(states[:, 2, 0], np.pi / 2)


@pytest.mark.parametrize("bias", [0.0, 3e3])
def test_a_held_demand_is_given_once_the_azimuths_are_there(bias, measured):
    rng, params, worst = np.random.default_rng(12), thrusters(bias=bias), 0.0
    state = allocation_start(params, AHEAD)
    for load in load_of(0.9 * random_thrust(rng, 20)):
        states, achieved = follow(params, state, np.tile(load, (400, 1)))
        state = states[-1]
        worst = max(worst, np.abs((achieved[-1] - load) / SCALE).max())
        np.testing.assert_allclose(achieved[-1], horizontal_load(params, state[:, 0], state[:, 1]))
    measured(f"allocation with rates, bias {bias:.0f} N, held demand: missed part of full load", worst, 1e-6)


@pytest.mark.parametrize("zones", [True, False])
def test_a_reversed_demand_turns_the_azimuths_once_and_without_dither(zones):
    rng, params = np.random.default_rng(13), thrusters(zones=zones)
    start = follow(params, allocation_start(params, AHEAD), np.tile([4e4, 0.0, 0.0], (100, 1)))[0][-1]
    noise = rng.normal(size=(300, 3)) * np.array([4e3, 4e3, 4e4])
    states, _ = follow(params, start, np.array([-4e4, 0.0, 0.0]) + noise)
    early = turns(states)[:120, :2]
    for turn in early.T:
        assert np.all(turn > 0.0) or np.all(turn < 0.0)
    assert np.all(np.cos(states[-1, :2, 0]) < -0.9)


def test_held_azimuths_stay_where_they_are_while_the_demand_is_small():
    rng, params = np.random.default_rng(14), thrusters(hold=2e3)
    demands = rng.normal(size=(100, 3)) * np.array([200.0, 200.0, 2e3])
    states, _ = follow(params, allocation_start(params, AHEAD), demands)
    np.testing.assert_allclose(states[:, :, 0], np.tile(AHEAD, (101, 1)))


def test_bias_keeps_azimuths_pushing_against_each_other_with_no_load():
    params = thrusters(bias=3e3)
    states, achieved = follow(params, allocation_start(params, AHEAD), np.zeros((300, 3)))
    np.testing.assert_allclose(states[-1, :, 1], [3e3, 3e3, 0.0], atol=1.0)
    np.testing.assert_allclose(states[-1, :2, 0], [-np.pi / 2, np.pi / 2], atol=1e-3)
    np.testing.assert_allclose(achieved[-1] / SCALE, 0.0, atol=1e-6)
    np.testing.assert_allclose(load_of(opposing_bias(POSITION, AZIMUTHING, 3e3)), 0.0, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("lost", range(3))
def test_a_failed_thruster_gets_nothing_at_once_and_the_others_take_over(method, lost):
    params, share = thrusters(method), np.where(np.arange(3) == lost, 0.0, 1.0)
    load = np.array([1e4, 2e3, 2e4])
    states, _ = follow(params, allocation_start(params, AHEAD), np.tile(load, (200, 1)))
    states, achieved = follow(params, states[-1], np.tile(load, (400, 1)), share)
    assert np.all(states[1:, lost, 1] == 0.0)
    others = np.arange(3) != lost
    assert np.all(np.abs(turns(states)) <= params.azimuth_step * (1.0 + 1e-9))
    assert np.all(np.abs(np.diff(states[:, others, 1], axis=0)) <= params.thrust_step[others] * (1.0 + 1e-9))
    if method == "qp":
        np.testing.assert_allclose(achieved[-1] / SCALE, load / SCALE, atol=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_with_all_thrusters_lost_nothing_is_asked_of_them(method):
    start = allocation_start(YAW_FIRST, AHEAD)
    states, achieved = follow(thrusters(method), start, np.tile(RANGE, (5, 1)), 0.0 * WHOLE)
    assert np.all(states[1:, :, 1] == 0.0)
    np.testing.assert_array_equal(achieved, 0.0)


def test_pseudo_inverse_is_the_least_norm_solution():
    rng, root = np.random.default_rng(15), np.repeat(np.sqrt(YAW_FIRST.power_share), 2)
    inverse = np.linalg.pinv(YAW_FIRST.effect / root) / root[:, None]
    for load in rng.uniform(-1.0, 1.0, (50, 3)) * RANGE:
        np.testing.assert_allclose(pseudo_inverse(YAW_FIRST, load, WHOLE), inverse @ (load / SCALE), atol=1e-8)


def test_far_from_all_limits_both_methods_agree():
    quick, full = thrusters("pseudo_inverse", zones=False), thrusters(zones=False)
    for load in np.random.default_rng(16).uniform(-0.2, 0.2, (50, 3)) * RANGE:
        np.testing.assert_allclose(static(quick, load), static(full, load), atol=1e-6 * 54e3)


def test_pseudo_inverse_cuts_all_thrusters_alike_so_that_the_load_keeps_its_direction():
    quick = thrusters("pseudo_inverse", zones=False)
    for load in np.random.default_rng(17).uniform(-4.0, 4.0, (50, 3)) * RANGE:
        got = load_of(static(quick, load)) / SCALE
        np.testing.assert_allclose(np.cross(got, load / SCALE), 0.0, atol=1e-8)
        assert got @ (load / SCALE) > 0.0


def test_a_command_far_ahead_of_its_servo_waits():
    stuck = np.array([0.0, 0.0, np.pi / 2])
    states, _ = follow(YAW_FIRST, allocation_start(YAW_FIRST, AHEAD), np.tile([-5e4, 0.0, 0.0], (100, 1)), WHOLE, stuck)
    lead = np.abs(states[:, :2, 0]).max()
    assert YAW_FIRST.lead_max[0] < lead <= YAW_FIRST.lead_max[0] + YAW_FIRST.azimuth_step[0]
    assert_rates_kept(YAW_FIRST, states)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_none_change_nothing_or_count_as_absent(method, bad):
    params = thrusters(method)
    state = follow(params, allocation_start(params, AHEAD), np.tile([1e4, 2e3, 2e4], (50, 1)))[0][-1]
    kept, _ = allocate(params, state, np.array([bad, 0.0, 0.0]), AHEAD, WHOLE)
    np.testing.assert_array_equal(kept, state)
    going, achieved = allocate(params, state, np.array([1e4, 0.0, 0.0]), np.full(3, bad), np.array([np.nan, 1.0, 1.0]))
    assert np.all(np.isfinite(going))
    assert np.all(np.isfinite(achieved))
    assert going[0, 1] == 0.0


def test_the_same_demands_give_the_same_bits_and_leave_inputs_untouched():
    loads = np.random.default_rng(18).uniform(-1.0, 1.0, (50, 3)) * RANGE
    start = allocation_start(YAW_FIRST, AHEAD)
    first, again = (follow(YAW_FIRST, start, loads)[0] for _ in range(2))
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(start, allocation_start(YAW_FIRST, AHEAD))


def test_an_unknown_method_is_told():
    with pytest.raises(ValueError, match="pseudo_inverse"):
        thrusters("guess")
