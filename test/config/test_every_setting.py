"""Every number of the settings changes a run, is refused, or is one of a few that must not matter."""

import copy

import pytest
from busy_scenario import (
    at_ends,
    busy,
    failing,
    filtered,
    flow_along_row,
    hungry,
    look,
    overloaded,
    put,
    relieved,
    slow,
    tucked,
    weak,
    without_power,
)
from pydantic import TypeAdapter, ValidationError

from shipcrane_twin.config.scenario import Scenario, problems
from shipcrane_twin.cosim.inline import InlineRun

READ = TypeAdapter(Scenario).validate_python

WITHOUT_EFFECT_ON_PHYSICS = {
    "lockstep.run_ahead_steps": "order of computing only",
    "lockstep.silence_timeout_s": "wall time only",
    "lockstep.speed": "wall time only",
    "recording.chunk_kib": "layout of the bag",
    "environment.current_profile.0.0": "the surface, refused elsewhere",
    "dp.settled_after_s": "from when the summary judges position",
    "vessel.thrusters.2.azimuth_rate_max_deg_s": "a tunnel thruster does not turn",
    "vessel.thrusters.2.azimuth_lag_s": "the same",
    "crane.load_limiter.warning": "what the operator is told",
    "crane.servo.tip_command_timeout_s": "an operator's tip commands only",
}
TABLES = (("vessel", "hull", "current_table"), ("vessel", "wind_areas", "table"))


def numbers(data, path=()):
    """Yield the path of every number in nested data."""
    children = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in children:
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield (*path, key)
        else:
            yield from numbers(value, (*path, key))


def digest(data):
    scenario = READ(data)
    if problems(scenario):
        return None
    run = InlineRun(scenario)
    for _ in run.steps():
        pass
    return run.digest


def small_changes(value, path):
    """Values near the given one; times and periods move by whole macro steps."""
    if isinstance(value, int):
        return [value + 1]
    if path[-1] in ("duration_s", "at_s", "from_s", "to_s", "enabled_at_s"):
        return [value + 0.02, value + 0.04]
    if path[-1] in ("macro_step_ms", "telemetry_period_ms", "period_ms"):
        return [value * 1.25, value * 1.2, value * 2.0, value * 0.5]
    step = 0.01 * abs(value) or 1e-3
    return [value + step, value - step]


def changed(data, path, value):
    out = copy.deepcopy(data)
    put(out, path, value)
    if path[-3:-2] == ("viscous_damping_frd",):  # which stays symmetric
        put(out, (*path[:-2], path[-1], path[-2]), value)
    return out


def matters(path, stages, digests):
    """Whether a small change of one number changes the digest of any of the stages."""
    for name, stage in stages.items():
        if name not in digests:
            digests[name] = digest(stage)
        for value in small_changes(look(stage, path), path):
            try:
                found = digest(changed(stage, path, value))
            except ValidationError:
                continue
            except ValueError:  # what the hull's database or the load chart refuses, it has been compared with
                return True
            if found not in (None, digests[name]):
                return True
    return False


def is_row_direction(path):
    return path[:-2] in TABLES and path[-1] == 0


PATHS = list(numbers(busy()))
STAGES = {"busy": busy(), "weak": weak(), "slow": slow(), "ekf": filtered(), "hungry": hungry()}
STAGES |= {"long": at_ends(1), "short": at_ends(-1), "tucked": tucked()}


def test_every_number_changes_the_run_or_is_listed():
    stages = STAGES | {event: without_power(event) for event in ("winch_coasts", "winch_leaks")}
    stages |= {"coast": failing("crane_coasts"), "brake": failing("crane_brakes", 0.01), "leak": failing("crane_leaks")}
    digests, silent = {}, []
    for path in PATHS:
        if is_row_direction(path):
            continue
        here, known = stages, digests
        if path[:-2] in TABLES:
            here, known = {path[-2]: flow_along_row(path, stages["busy"])}, {}
        if path[:2] == ("crane", "load_chart"):
            here, known = {"overloaded": overloaded(path[2])}, {}
        elif path[:2] == ("crane", "load_limiter"):
            here, known = {"overloaded": overloaded(3), "relieved": relieved()}, {}
        if not matters(path, here, known):
            silent.append(".".join(map(str, path)))
    assert sorted(silent) == sorted(WITHOUT_EFFECT_ON_PHYSICS)


@pytest.mark.parametrize("table", TABLES, ids=["current", "wind"])
def test_directions_of_a_table_are_refused_unless_even(table):
    data = busy()
    for row in range(len(look(data, table))):
        with pytest.raises(ValidationError, match="in equal steps in the first column"):
            READ(changed(data, (*table, row, 0), look(data, (*table, row, 0)) + 1.0))


def test_kind_of_thruster_changes_the_run():
    data = busy()
    assert digest(changed(data, ("vessel", "thrusters", 0, "azimuthing"), False)) != digest(data)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("dp", "observer", "kind"), "ekf"),
        (("dp", "observer", "kind"), "none"),
        (("dp", "observer", "adaptive"), False),
        (("dp", "sensors", "perfect"), True),
        (("dp", "reference", "together"), True),
        (("dp", "allocation", "method"), "pseudo_inverse"),
        (("dp", "weathervane", "enabled"), True),
        (("coupling",), "in_turn"),
        (("environment", "wind_gusts"), "harris"),
        (("environment", "waves", "first_order"), False),
        (("environment", "waves", "slow_drift"), False),
        (("environment", "waves", "systems", 2, "spectrum"), "pierson_moskowitz"),
        (("vessel", "ballast"), {"mode": "level", "heave_n": 0.0, "roll_n_m": 0.0, "pitch_n_m": 0.0}),
    ],
    ids=lambda part: ".".join(map(str, part)) if isinstance(part, tuple) else str(part),
)
def test_a_choice_changes_the_run(path, value):
    data = busy()
    assert digest(changed(data, path, value)) not in (None, digest(data))


def test_what_saturated_thrusters_keep_changes_the_run():
    data = slow()
    assert digest(changed(data, ("dp", "allocation", "priority"), "position")) not in (None, digest(data))


@pytest.mark.parametrize(
    "happens",
    [
        {"event": "thruster_fault", "which": "azimuth_port", "fault": "failed"},
        {"event": "thruster_fault", "which": "azimuth_port", "fault": "frozen"},
        {"event": "thruster_fault", "which": "azimuth_port", "fault": "runaway"},
        {"event": "sensor_fault", "which": "gyro", "fault": "drop_out"},
        {"event": "sensor_fault", "which": "gyro", "fault": "frozen"},
        {"event": "sensor_fault", "which": "mru", "fault": "drop_out"},
        {"event": "sensor_fault", "which": "wind", "fault": "frozen"},
        {"event": "dp_off"},
    ],
    ids=lambda keys: " ".join(keys.values()),
)
def test_an_event_changes_the_run(happens):
    data = busy()
    events = [*data["events"], {"label": "more", "at_s": 0.2, **happens}]
    assert digest(changed(data, ("events",), events)) not in (None, digest(data))


def test_there_are_several_hundred_numbers():
    assert len(PATHS) > 300
