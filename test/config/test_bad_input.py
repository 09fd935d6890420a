"""Wrong settings: one message with file, key, value, expectation and remedy."""

import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.places import config_dir
from shipcrane_twin.config.settings import ConfigError

CASE2 = str(config_dir() / "scenarios" / "case2.yaml")
GOOD = "use: defaults.yaml\ntitle: A test\nduration_s: 10.0\n"


def message_of(*overrides, name="case2"):
    with pytest.raises(ConfigError) as caught:
        load_scenario(str(name), overrides)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.fixture
def scenario_file(tmp_path):
    def write(text):
        path = tmp_path / "mine.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


OVERRIDES = {
    "unknown key": ("wire.diametr_m=0.02", "wire.diametr_m is unknown; did you mean diameter_m?"),
    "unknown key in a list": ("operations.0.form_s=1.0", "operations[0].form_s is unknown; did you mean from_s?"),
    "unit clash": ("wire.diameter_mm=20", "wire.diameter_mm is unknown; unit clash: this setting is diameter_m "),
    "unit clash of angles": ("operations.0.velocity_deg_s=1.0", "unit clash: this setting is velocity_rad_s "),
    "text for a number": ("winch.speed_max_m_s=fast", "winch.speed_max_m_s is 'fast', expected a valid number"),
    "number for text": ("title=3", "title is 3, expected a valid string"),
    "fraction for a count": ("seed=1.5", "seed is 1.5, expected a valid integer"),
    "truth for a count": ("seed=true", "seed is True, expected a valid integer"),
    "number for a truth": ("vessel.thrusters.0.azimuthing=1", "vessel.thrusters[0].azimuthing is 1, expected a valid"),
    "value for a group": ("winch=3", "winch is 3, expected a group with the keys initial_length_m, "),
    "out of range": ("crane.links.1.mass_kg=-3", "crane.links[1].mass_kg is -3, expected greater than 0"),
    "too large": ("macro_step_ms=300", "macro_step_ms is 300, expected less than or equal to 200"),
    "not a number": ("constants.gravity_m_s2=.nan", "constants.gravity_m_s2 is nan, expected a finite number"),
    "infinite": ("payload.mass_kg=.inf", "payload.mass_kg is inf, expected a finite number"),
    "no such choice": ("recording.compression=gzip", "recording.compression is 'gzip', expected 'zstd' or 'none'"),
    "no such event": ("events.0.event=explode", "events[0].event is 'explode', expected 'release_payload', '"),
    "missing": ("constants={}", "constants.gravity_m_s2 is missing; add it"),
    "step that does not divide": (
        "macro_step_ms=30",
        "macro_step_ms is 30, expected a step that divides telemetry_period_ms, dp.period_ms, dp.enabled_at_s; "
        "steps that do: 1, 2, 4, 5, 10, 20, 25, 50, 100",
    ),
    "step below a nanosecond": ("macro_step_ms=0.00000013", "macro_step_ms is 1.3e-07, expected whole nanoseconds"),
    "no such joint": (
        "operations.0.joint=bom",
        "operations[0].joint is 'bom', expected one of slew, boom, knuckle, telescope, winch",
    ),
    "speed in the wrong unit": ("operations.0.velocity_m_s=0.1", "expected exactly one of velocity_rad_s or"),
    "moves that overlap": ("operations.2.from_s=230.0", "expected no overlap with another move of boom, 220 to 242 s"),
    "end before start": ("operations.0.to_s=200.0", "operations[0].to_s is 200.0, expected a time after from_s = 220"),
    "too few joints": (
        "crane.initial_joints=[1.0, 2.0]",
        "crane.initial_joints is [1.0, 2.0], expected 4 values, one per joint (slew, boom, knuckle, telescope)",
    ),
    "unit clash of sensors": ("dp.sensors.gyro.noise_std_rad=0.1", "unit clash: this setting is noise_std_deg"),
    "no such observer": ("dp.observer.kind=kalman", "kind is 'kalman', expected 'passive', 'ekf' or 'none'"),
    "no such thruster": (
        "events=[{label: a, at_s: 1.0, event: thruster_fault, which: rudder, fault: failed}]",
        "events[0].which is 'rudder', expected one of azimuth_port, azimuth_starboard, bow_tunnel with the event "
        "thruster_fault",
    ),
    "no such sensor": (
        "events=[{label: a, at_s: 1.0, event: sensor_fault, which: radar, fault: frozen}]",
        "events[0].which is 'radar', expected one of position, gyro, mru, wind with the event sensor_fault",
    ),
    "thruster's fault of a sensor": (
        "events=[{label: a, at_s: 1.0, event: sensor_fault, which: gyro, fault: runaway}]",
        "events[0].fault is 'runaway', expected one of none, drop_out, frozen with the event sensor_fault",
    ),
    "sensor's fault of a thruster": (
        "events=[{label: a, at_s: 1.0, event: thruster_fault, which: bow_tunnel, fault: drop_out}]",
        "events[0].fault is 'drop_out', expected one of none, failed, frozen, limited, runaway with the event",
    ),
    "limit without a share": (
        "events=[{label: a, at_s: 1.0, event: thruster_fault, which: bow_tunnel, fault: limited}]",
        "events[0].share is None, expected a share with thruster_fault",
    ),
    "power limit without a share": ("events=[{label: a, at_s: 1.0, event: power_limit}]", "expected a share with"),
    "share of a failed thruster": (
        "events=[{label: a, at_s: 1.0, event: thruster_fault, which: bow_tunnel, fault: failed, share: 0.5}]",
        "events[0].share is 0.5, expected none with thruster_fault",
    ),
    "thruster of a switch": (
        "events=[{label: a, at_s: 1.0, event: dp_off, which: bow_tunnel}]",
        "events[0].which is 'bow_tunnel', expected none with the event dp_off",
    ),
    "share above one": (
        "events=[{label: a, at_s: 1.0, event: power_limit, share: 1.5}]",
        "events[0].share is 1.5, expected less than or equal to 1",
    ),
    "sensor off DP's grid": (
        "dp.sensors.position.period_ms=250.0",
        "dp.sensors.position.period_ms is 250.0, expected a whole multiple of dp.period_ms = 100",
    ),
    "sector that is a circle": (
        "vessel.thrusters.0.forbidden.0.half_width_deg=200.0",
        "vessel.thrusters[0].forbidden[0].half_width_deg is 200.0, expected less than 180",
    ),
    "zone that protects nobody": (
        "vessel.thrusters.0.forbidden.0.protects=azimuth_port",
        "forbidden[0].protects is 'azimuth_port', expected one of azimuth_starboard, bow_tunnel",
    ),
    "sensor faster than DP": ("dp.sensors.gyro.period_ms=50.0", "expected a whole multiple of dp.period_ms = 100"),
    "less wire than it pays out": (
        "winch.drum.wire_length_m=50.0",
        "winch.drum.wire_length_m is 50.0, expected at least winch.length_max_m = 100",
    ),
    "shape without its group": ("payload.shape=box", "expected the group box with shape: box, and only then"),
    "two joints of one name": ("crane.links.0.joint=boom", "expected a name of its own; there is another boom"),
    "wire beyond the drum": (
        "winch.initial_length_m=200.0",
        "winch.initial_length_m is 200.0, expected a length within the winch's limits, 0.2 to 100",
    ),
    "hook heavier than all": (
        "payload.hook_mass_kg=800.0",
        "payload.hook_mass_kg is 800.0, expected no more than payload.mass_kg = 700, a part of it",
    ),
    "asymmetric matrix": ("vessel.hull.viscous_damping_frd.0.1=1.0e+6", "viscous_damping_frd is [[0.0, "),
    "no such ballast": ("vessel.ballast.mode=water", "vessel.ballast.mode is 'water', expected 'none', 'level' or"),
    "ballast that nothing reads": ("vessel.ballast={mode: none, roll_n_m: 5.0}", "is 'none', expected 'values', "),
    "no such spectrum": (
        "environment.waves.systems=[{spectrum: pm, direction_to_deg: 0.0}]",
        "environment.waves.systems[0].spectrum is 'pm', expected 'regular', 'jonswap', 'pierson_moskowitz', ",
    ),
    "keys of another spectrum": (
        "environment.waves.systems=[{spectrum: regular, direction_to_deg: 0.0, peak_period_s: 8.0, height_m: 1.0}]",
        "expected height_m, period_s with the spectrum regular",
    ),
    "spread regular wave": (
        "environment.waves.systems=[{spectrum: regular, direction_to_deg: 0.0, period_s: 8.0, height_m: 1.0, "
        "spreading_exponent: 4.0}]",
        "expected none: a regular wave has one direction",
    ),
    "unit clash of waves": (
        "environment.waves.systems=[{spectrum: regular, direction_to_rad: 0.0, period_s: 8.0, height_m: 1.0}]",
        "unit clash: this setting is direction_to_deg",
    ),
    "depths out of order": (
        "environment.current_profile=[[5.0, 1.0], [0.0, 0.5]]",
        "expected depths that rise from 0, the surface",
    ),
    "uneven directions": (
        "vessel.wind_areas.table.3.0=31.0",
        "expected directions from 0 to 180 degrees in equal steps in the first column",
    ),
    "keys of another drive": (
        "crane.links.1.drive.kind=motor",
        "expected for kind motor the keys accel_max_rad_s2, brake_torque_n_m,",
    ),
}


@pytest.mark.parametrize(("override", "said"), OVERRIDES.values(), ids=OVERRIDES.keys())
def test_message_names_key_value_and_expectation(override, said):
    message = message_of(override)
    assert message.startswith("--set: ")
    assert said in message
    assert len(message) < 400


@pytest.mark.parametrize("number", ["5e5", "5e-1", "5.0e5", "+5E5", ".5e5"])
def test_number_that_yaml_reads_as_text_is_explained(number):
    message = message_of(f"constants.gravity_m_s2={number}")
    assert f"constants.gravity_m_s2 is '{number}'" in message
    assert "YAML reads this as text, write it with a point and a signed exponent, like 5.0e+5" in message


MALFORMED = {
    "nonsense": "--set 'nonsense': expected key=value, for instance macro_step_ms=50",
    "=3": "--set '=3': expected key=value",
    "wire.diameter_m=[1": "--set 'wire.diameter_m=[1': the value is not valid YAML",
    "rope.diameter_m=1.0": "--set rope.diameter_m: there is no group rope to set a key in",
    "crane.links.9.mass_kg=1.0": "--set crane.links.9.mass_kg: there is no group crane.links.9",
    "crane.initial_joints.7=1.0": "--set crane.initial_joints.7: index 7 is outside the list",
}


@pytest.mark.parametrize(("override", "said"), MALFORMED.items(), ids=MALFORMED.keys())
def test_override_that_cannot_be_placed_is_explained(override, said):
    assert message_of(override).startswith(said)


FILES = {
    "unknown key": (GOOD + "wire: {diametr_m: 0.1}\n", "wire.diametr_m is unknown; did you mean diameter_m?"),
    "wrong type": (GOOD + "vessel: {draught_m: heavy}\n", "vessel.draught_m is 'heavy', expected a valid number"),
    "number as text": (GOOD + "wire: {diameter_m: 5e5}\n", "wire.diameter_m is '5e5', expected a valid number; YAML"),
    "no speed": (
        GOOD + "operations:\n - {label: a, joint: boom, from_s: 1.0, to_s: 2.0}\n",
        "operations[0] is {'label': 'a', 'joint': 'boom', 'from_s': 1.0, 'to_s': 2.0}, expected exactly one",
    ),
    "step that does not divide": (
        GOOD + "macro_step_ms: 15.0\n",
        "macro_step_ms is 15.0, expected a step that divides duration_s,",
    ),
    "duplicate key": (GOOD + "title: Again\n", "not valid YAML: the key 'title' is given twice; keep one"),
    "duplicate key inside": (GOOD + "wire: {diameter_m: 0.1, diameter_m: 0.2}\n", "'diameter_m' is given twice"),
    "key that is no text": (GOOD + "1: 3\n", "the key 1 is not text"),
    "not YAML": ("use: [1\n", "not valid YAML: while parsing"),
    "list": ("- 1\n", "expected a mapping of keys to values, found list"),
    "empty": ("", "expected a mapping of keys to values, found NoneType"),
    "no such use": ("use: rope.yaml\n", "use is 'rope.yaml', expected a YAML file beside it or under "),
    "use of itself": ("use: mine.yaml\n", "use is 'mine.yaml', which uses this file in turn; break the circle"),
    "unsafe tag": ("!!python/object:os.system x\n", "not valid YAML: could not determine a constructor"),
}


@pytest.mark.parametrize(("text", "said"), FILES.values(), ids=FILES.keys())
def test_message_names_the_file(scenario_file, text, said):
    path = scenario_file(text)
    message = message_of(name=path)
    assert message.startswith(f"{path}: ")
    assert said in message


def test_circle_of_two_files_is_refused(scenario_file, tmp_path):
    (tmp_path / "other.yaml").write_text("use: mine.yaml\n", encoding="utf-8")
    assert "break the circle" in message_of(name=scenario_file("use: other.yaml\n"))


def test_binary_file_is_refused(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_bytes(b"\xff\xfe\x00")
    assert message_of(name=path).startswith(f"{path}: cannot be read")


def test_value_that_a_used_file_brought_names_both_files(scenario_file):
    path = scenario_file("use: defaults.yaml\ntitle: A test\nduration_s: 10.01\n")
    assert message_of(name=path).startswith(f"{path} (through defaults.yaml): macro_step_ms is 20.0, ")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("caes2", "scenario 'caes2' is unknown; did you mean case2?"),
        ("zzz", "scenario 'zzz' is unknown; there are "),
        ("zzz.yaml", "zzz.yaml: no such scenario file; give a path to a YAML file or one of "),
    ],
)
def test_unknown_scenario_names_the_nearest_or_all(name, said):
    message = message_of(name=name)
    assert message.startswith(said)
    assert "case2" in message


def test_unknown_key_is_told_before_the_missing_one_that_it_caused():
    message = message_of("constants={gravity_ms2: 9.8, water_density_kg_m3: 1025.0, air_density_kg_m3: 1.2}")
    assert message == "--set: constants.gravity_ms2 is unknown; did you mean gravity_m_s2?"


def test_value_of_the_scenario_itself_names_its_file_though_another_value_was_overridden():
    message = message_of("operations.0.from_s=300.0")
    assert message.startswith(f"{CASE2}: operations[0].to_s is 242.0, expected a time after from_s = 300")
