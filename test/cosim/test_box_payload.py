"""The payload subsystem by itself: a box in the splash zone, on decks, picked up and let go; each number matters."""

import copy
import hashlib

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from scipy.spatial.transform import Rotation

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import Scenario, problems
from shipcrane_twin.config.settings import plain
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.lifting import LoadWeather, rigid_params
from shipcrane_twin.cosim.subsystems.payload import Payload
from shipcrane_twin.physics.frames import quat_from_euler
from shipcrane_twin.physics.vessel_step import vessel_at_rest, vessel_outputs

READ = TypeAdapter(Scenario).validate_python
BOX = {
    "length_m": 2.0,
    "breadth_m": 1.5,
    "height_m": 1.0,
    "cog_m": [0.05, -0.02, -0.1],
    "heading_deg": 20.0,
    "displaced_share": 0.3,
    "perforation": 0.1,
    "air_drag_coefficient": 1.2,
    "drag_coefficient": 2.0,
    "slamming_coefficient": 5.0,
    "sling": {"lug_distance_m": 1.6, "lug_height_m": 0.5, "leg_length_m": 1.5, "leg_stiffness_n_m": 2.0e6},
    "contact": {"stiffness_n_m": 2.0e6, "loss_s_m": 0.3, "friction": 0.4},
}
AT_EDGES = ("length_m", "breadth_m", "heading_deg")
"""What of a plane matters only where the box meets an edge."""

SHIP_DECK = {"label": "deck", "moves_with": "ship", "length_m": 40.0, "breadth_m": 40.0, "heading_deg": 10.0}
SUPPLY = {
    "label": "barge", "moves_with": "supply", "length_m": 30.0, "breadth_m": 30.0, "heading_deg": 40.0,
    "heave_amplitude_m": 0.3, "heave_period_s": 5.0, "heave_phase_deg": 30.0,
}  # fmt: skip


def base(**box):
    data = plain(load_scenario("case2"))
    data["duration_s"] = 4.0
    data["operations"] = [{"label": "w", "joint": "winch", "from_s": 0.2, "to_s": 3.0, "velocity_m_s": -0.3}]
    data["events"] = []
    data["crane"]["initial_joints"][1:3] = [0.8, 0.7]  # the tip about 10 m up
    data["wire"] |= {"mass_kg_m": 1.6, "sheave_friction": 0.05}
    data["winch"]["initial_length_m"] = 3.0
    data["payload"] = {"mass_kg": 1500.0, "hook_mass_kg": 80.0, "shape": "box", "box": {**copy.deepcopy(BOX), **box}}
    env = data["environment"]
    env |= {"current_speed_m_s": 0.4, "wind_speed_m_s": 8.0}
    system = {"spectrum": "regular", "direction_to_deg": 40.0, "height_m": 0.8, "period_s": 6.0}
    env["waves"] |= {"systems": [system], "ramp_s": 0.0}
    return data


def still(scenario):
    """Tip and ship at rest."""
    rest = at_rest(scenario)
    tip = np.zeros(13)
    tip[:3], tip[6] = rest.tip_w, 1.0
    ship = vessel_outputs(vessel_at_rest(rest.params, rest.vessel, rest.inertia, 0), rest.params.cog)[0]
    return {"/crane/tip": tip, "/vessel/odom": ship, "/crane/load_state": np.zeros(5)}


def drive(data):
    """Step the subsystem under a tip at rest; the subsystem and its odometry and wrench."""
    scenario = READ(data)
    assert not problems(scenario)
    payload, around = Payload(scenario), still(scenario)
    rows = [payload.start()]
    for k in range(1, scenario.step_count + 1):
        rows.append(payload.step(k, around))
    return payload, np.array([np.concatenate((row["/payload/odom"], row["/payload/wire_wrench"])) for row in rows])


def in_water():
    """Lowered through the surface on a winch that hardly holds it."""
    data = base()
    tip = at_rest(READ(data)).tip_w
    data["winch"]["initial_length_m"] = float(tip[2]) - 2.4
    data["operations"][0]["velocity_m_s"] = 0.4
    return data


def on_supply():
    data = base(rests_on="barge", planes=[{**SUPPLY, "centre_m": [0.0, -10.0, 1.0]}])
    tip = at_rest(READ(data)).tip_w
    data["payload"]["box"]["planes"][0]["centre_m"] = [float(tip[0]) + 3.0, float(tip[1]) - 2.0, 1.0]
    data["winch"]["initial_length_m"] = float(tip[2]) - 3.1
    data["operations"][0] |= {"velocity_m_s": -0.5, "to_s": 4.0}
    return data


def onto_deck():
    """Lowered onto the ship's deck, then let go."""
    data = base(planes=[{**SHIP_DECK, "centre_m": [5.0, 0.0, 6.0]}])
    tip, ship = (still(READ(data))[name] for name in ("/crane/tip", "/vessel/odom"))
    data["payload"]["box"]["planes"][0]["centre_m"] = [5.0, 2.0, float(tip[2] - ship[2]) - 5.6]
    data["operations"][0] |= {"velocity_m_s": 0.5, "from_s": 0.0, "to_s": 3.0}
    data["events"] = [{"label": "off", "at_s": 3.4, "event": "release_payload"}]
    return data


def test_lowered_into_the_water_the_wire_is_relieved_of_the_buoyancy():
    data = in_water()
    data["operations"][0]["to_s"], data["duration_s"] = 10.0, 14.0
    data["environment"]["waves"]["systems"] = []
    payload, rows = drive(data)
    dry, wet = -rows[0, 15], -rows[-50:, 15].mean()
    buoyancy = 1025.0 * 9.80665 * 0.3 * 2.0 * 1.5 * 1.0
    assert rows[-1, 2] < -1.0
    own = 1.6 * 9.80665 * (payload._load.line[0] - data["winch"]["initial_length_m"])
    assert dry - wet + own == pytest.approx(buoyancy, rel=0.05)


def test_picked_up_from_a_heaving_supply_deck():
    payload, rows = drive(on_supply())
    seen = payload.events()
    assert -rows[0, 15] == pytest.approx((80.0 + 1.6 * READ(on_supply()).winch.initial_length_m) * 9.80665)
    assert seen["lift_offs"] >= 1.0
    # at first it heaves with the deck
    rate = 2.0 * np.pi / 5.0
    wave = 0.3 * np.sin(rate * 0.02 * np.arange(40) + np.deg2rad(30.0))
    np.testing.assert_allclose(np.diff(rows[:40, 2] - wave), 0.0, atol=2e-3)
    assert -rows[-1, 15] > 1300.0 * 9.8
    assert seen["tension_max_n"] > 1500.0 * 9.8


def test_landed_on_the_ship_and_let_go():
    payload, rows = drive(onto_deck())
    seen = payload.events()
    assert seen["landings"] >= 1.0
    assert 0.2 < seen["impact_speed_max_m_s"] < 1.0
    assert np.abs(np.diff(rows[-20:, 2])).max() < 1e-3
    assert any("landed" in line for line in payload.warnings())
    assert -rows[-1, 15] == pytest.approx((80.0 + 1.6 * payload._load.line[0]) * 9.80665, rel=0.05)


def test_events_of_the_winch_reach_the_drum():
    for event, falls in (("winch_brakes", False), ("winch_leaks", True), ("winch_coasts", True)):
        data = base()
        data["operations"] = []
        data["events"] = [{"label": "e", "at_s": 0.5, "event": event}]
        payload, rows = drive(data)
        assert (rows[-1, 2] < rows[20, 2] - 0.01) == falls
        assert (payload.events()["drum_slipped_s"] > 0.0) == falls


def test_water_at_the_load_is_that_of_the_environment():
    scenario = READ(base())
    around = LoadWeather(scenario, scenario.payload.box)
    water = around.water(1.5, np.array([3.0, 4.0, -1e3]))
    omega = 2.0 * np.pi / 6.0
    number = omega**2 / 9.80665
    along = 3.0 * np.sin(np.deg2rad(40.0)) + 4.0 * np.cos(np.deg2rad(40.0))
    phase = float(around._sea.phase[0])
    assert water[0] == pytest.approx(0.4 * np.cos(omega * 1.5 - number * along + phase), rel=1e-6)
    assert np.hypot(*water[1:3]) == pytest.approx(0.4, rel=1e-3)
    assert np.linalg.norm(around.wind(0.3)) > 0.0


def test_a_plane_lies_where_and_as_its_settings_say():
    planes = [{**SHIP_DECK, "centre_m": [5.0, 2.0, 6.0]}, {**SUPPLY, "centre_m": [7.0, 8.0, 1.0]}]
    scenario = READ(base(planes=planes))
    ship = np.concatenate(([1.0, 2.0, 3.0], quat_from_euler(0.1, 0.2, 0.3), [0.5, 0.1, 0.2], [0.01, 0.02, 0.03]))
    deck, barge = LoadWeather(scenario, scenario.payload.box).planes(2.0, ship)
    rot = Rotation.from_quat(ship[3:7]).as_matrix()
    np.testing.assert_allclose(deck[:3], ship[:3] + rot @ [5.0, 2.0, 6.0])
    np.testing.assert_allclose(deck[3:6], rot @ (ship[7:10] + np.cross(ship[10:], [5.0, 2.0, 6.0])))
    starboard = np.deg2rad(10.0)
    np.testing.assert_allclose(deck[6:15].reshape(3, 3)[:, 0], rot @ [np.cos(starboard), -np.sin(starboard), 0.0])
    np.testing.assert_allclose(deck[15:], rot @ ship[10:])
    east = np.deg2rad(40.0)
    np.testing.assert_allclose(barge[6:15].reshape(3, 3)[:, 0], [np.sin(east), np.cos(east), 0.0], atol=1e-12)
    rate, phase = 2.0 * np.pi / 5.0, np.deg2rad(30.0)
    assert barge[2] == pytest.approx(1.0 + 0.3 * np.sin(2.0 * rate + phase))
    assert barge[5] == pytest.approx(0.3 * rate * np.cos(2.0 * rate + phase))
    np.testing.assert_allclose(rigid_params(scenario, scenario.payload.box).planes[:, :2], [[20.0] * 2, [15.0] * 2])


def test_the_sea_floor_is_there_where_a_depth_is_given():
    data = base()
    data["environment"]["water_depth_m"] = 25.0
    scenario = READ(data)
    assert LoadWeather(scenario, scenario.payload.box).planes(0.0, np.zeros(13))[-1, 2] == -25.0


def numbers(data, path=()):
    children = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in children:
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield (*path, key)
        else:
            yield from numbers(value, (*path, key))


def changed(data, path, value):
    out = copy.deepcopy(data)
    place = out
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return out


def fingerprint(data):
    return hashlib.sha256(drive(data)[1].tobytes()).digest()


def test_every_number_of_the_box_changes_a_run():
    stages = [in_water(), on_supply(), onto_deck()]
    kept = [fingerprint(stage) for stage in stages]
    silent, seen = [], set()
    for stage in stages:
        for path in numbers(stage["payload"]):
            if (path in seen and "planes" not in path) or ("planes" in path and path[-1] in AT_EDGES):
                continue
            seen.add(path)
            for one, known in zip(stages, kept, strict=True):
                place = one["payload"]
                try:
                    for key in path:
                        place = place[key]
                except (KeyError, IndexError):
                    continue
                step = 0.01 * abs(place) or 1e-3
                found = None
                for value in (place + step, place - step):
                    try:
                        found = fingerprint(changed(one, ("payload", *path), value))
                        break
                    except ValidationError:
                        continue
                if found not in (None, known):
                    break
            else:
                silent.append(".".join(map(str, path)))
    assert len(seen) > 25
    assert silent == []


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("shape",), "point", "the group box with shape: box, and only then"),
        (("hook_mass_kg",), 1500.0, "hook_mass_kg below mass_kg"),
        (("box", "sling", "leg_length_m"), 0.7, "leg_length_m above half of lug_distance_m"),
        (("box", "rests_on"), "quay", "rests_on among the labels of planes"),
        (("box", "planes"), [{**SHIP_DECK, "centre_m": [0.0, 0.0, 0.0]}] * 2, "planes with different labels"),
        (("box", "planes"), [{**SUPPLY, "moves_with": "ground", "centre_m": [0.0] * 3}], "for a plane on a supply"),
    ],
    ids=lambda part: ".".join(part) if isinstance(part, tuple) else None,
)
def test_what_does_not_fit_is_refused(path, value, said):
    with pytest.raises(ValidationError, match=said):
        READ(changed(base(), ("payload", *path), value))
