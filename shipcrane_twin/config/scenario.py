"""A scenario: everything a run depends on, and the checks across its parts."""

from collections.abc import Sequence
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le

from shipcrane_twin.config.controllers import ControllerConfig, controller_problems, steered_joints
from shipcrane_twin.config.crane import CraneConfig, NotNegative, Positive
from shipcrane_twin.config.dp import DpConfig
from shipcrane_twin.config.environment import WAVE_KEYS, EnvironmentConfig
from shipcrane_twin.config.lifting import PayloadConfig, WinchConfig, WireConfig
from shipcrane_twin.config.settings import Number, Text, Whole, settings
from shipcrane_twin.config.vessel import VesselConfig

NS_PER_MS = 1_000_000
NS_PER_S = 1_000_000_000
WINCH = "winch"

MOVES = {"revolute": ("velocity_rad_s", "position_rad"), "prismatic": ("velocity_m_s", "position_m")}
"""What an operation may say to a joint of each kind."""

SENSORS = ("position", "gyro", "mru", "wind")
THRUSTER_FAULTS = ("none", "failed", "frozen", "limited", "runaway")
SENSOR_FAULTS = ("none", "drop_out", "frozen")


@settings
class ConstantsConfig:
    """One gravity, one water, one air for all parts."""

    gravity_m_s2: Annotated[Number, Gt(0), Le(30)]
    water_density_kg_m3: Positive
    air_density_kg_m3: Positive


@settings
class LockstepConfig:
    """How the graph keeps step; none of it can change a result."""

    run_ahead_steps: Annotated[Whole, Ge(1), Le(50)]
    silence_timeout_s: Positive
    speed: NotNegative


@settings
class OperationConfig:
    """One joint command: a velocity held, or a position gone to, from one time to another; then the joint stands.

    The winch's position is the paid-out length.
    """

    label: Text
    joint: Text
    from_s: NotNegative
    to_s: NotNegative
    velocity_rad_s: Number | None = None
    velocity_m_s: Number | None = None
    position_rad: Number | None = None
    position_m: Number | None = None


@settings
class EventConfig:
    """Something that happens at one time.

    ``release_payload``: the load comes off the hook. ``thruster_fault``: ``which`` is a thruster, ``fault`` what it
    does from then on, ``share`` of its thrust with the fault limited. ``sensor_fault``: ``which`` is a sensor; it
    drops out or freezes. The fault none repairs. ``power_limit``: ``share`` of the total power is left. ``dp_on``,
    ``dp_off``: from then on ``dp.enabled_at_s`` has no say. ``power_failure``: crane and winch lose their power and
    their brakes shut, as those of each alone do with ``crane_brakes`` and ``winch_brakes``; with ``..._coasts`` nothing
    but friction is left, with ``..._leaks`` what should hold the oil leaks.
    """

    label: Text
    at_s: NotNegative
    event: Literal[
        "release_payload",
        "thruster_fault",
        "sensor_fault",
        "power_limit",
        "dp_on",
        "dp_off",
        "power_failure",
        "crane_coasts",
        "crane_brakes",
        "crane_leaks",
        "winch_coasts",
        "winch_brakes",
        "winch_leaks",
    ]
    which: Text | None = None
    fault: Literal["none", "failed", "frozen", "limited", "runaway", "drop_out"] | None = None
    share: Annotated[Number, Ge(0), Le(1)] | None = None


@settings
class RecordingConfig:
    """How the bag is written."""

    compression: Literal["zstd", "none"]
    chunk_kib: Annotated[Whole, Ge(16), Le(65536)]


@settings
class Scenario:
    """A complete, resolved scenario."""

    name: Text
    title: Text
    seed: Annotated[Whole, Ge(0)]
    duration_s: Positive
    macro_step_ms: Annotated[Number, Gt(0), Le(200)]
    telemetry_period_ms: Positive
    coupling: Text
    constants: ConstantsConfig
    lockstep: LockstepConfig
    environment: EnvironmentConfig
    vessel: VesselConfig
    dp: DpConfig
    crane: CraneConfig
    wire: WireConfig
    winch: WinchConfig
    payload: PayloadConfig
    operations: tuple[OperationConfig, ...] = ()
    events: tuple[EventConfig, ...] = ()
    controllers: tuple[ControllerConfig, ...] = ()
    recording: RecordingConfig

    @property
    def step_ns(self) -> int:
        """The macro step [ns]."""
        return round(self.macro_step_ms * NS_PER_MS)

    @property
    def step_count(self) -> int:
        """How many macro steps the run has."""
        return round(self.duration_s * NS_PER_S) // self.step_ns

    @property
    def telemetry_every(self) -> int:
        """How many macro steps lie between two telemetry messages."""
        return round(self.telemetry_period_ms * NS_PER_MS) // self.step_ns

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the crane's joints, base to tip."""
        return tuple(link.joint for link in self.crane.links)


def problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Return what is wrong across the parts of a scenario: key path and advice for each.

    Parameters
    ----------
    scenario : Scenario
        Already right in types and single ranges.
    """
    return [
        *time_problems(scenario),
        *crane_problems(scenario),
        *operation_problems(scenario),
        *sensor_problems(scenario),
        *event_problems(scenario),
        *zone_problems(scenario),
        *winch_problems(scenario),
        *controller_problems(scenario.controllers, (*scenario.joint_names, WINCH)),
        *weather_problems(scenario),
    ]


def time_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check that the macro step is whole nanoseconds and divides every period."""
    step_ns = scenario.macro_step_ms * NS_PER_MS
    if abs(step_ns - round(step_ns)) > 1e-6:
        return [(["macro_step_ms"], "expected whole nanoseconds")]
    periods_ns = {
        "duration_s": scenario.duration_s * NS_PER_S,
        "telemetry_period_ms": scenario.telemetry_period_ms * NS_PER_MS,
        "dp.period_ms": scenario.dp.period_ms * NS_PER_MS,
        "dp.enabled_at_s": scenario.dp.enabled_at_s * NS_PER_S,
    }

    def undivided(step: int) -> list[str]:
        return [key for key, value in periods_ns.items() if abs(value - step * round(value / step)) > 1e-3]

    wrong = undivided(scenario.step_ns)
    if not wrong:
        return []
    fitting = [str(ms) for ms in (1, 2, 4, 5, 10, 20, 25, 40, 50, 100) if not undivided(ms * NS_PER_MS)]
    advice = f"; steps that do: {', '.join(fitting)}" if fitting else "; make the periods whole milliseconds"
    return [(["macro_step_ms"], f"expected a step that divides {', '.join(wrong)}{advice}")]


def crane_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check that every joint of the crane has a name of its own and a start value."""
    crane = scenario.crane
    count = len(crane.links)
    found: list[tuple[list[str | int], str]] = []
    if len(crane.initial_joints) != count:
        names = ", ".join(scenario.joint_names)
        found.append((["crane", "initial_joints"], f"expected {count} values, one per joint ({names})"))
    taken = [*scenario.joint_names, WINCH]
    for i, name in enumerate(scenario.joint_names):
        if taken.count(name) > 1:
            found.append((["crane", "links", i, "joint"], f"expected a name of its own; there is another {name}"))
        if bool(crane.links[i].segments) and crane.links[i].kind != "prismatic":
            found.append((["crane", "links", i, "segments"], "expected none: only a prismatic joint has segments"))
    return found


def operation_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check joints, times and units of the operations and the times of events."""
    found: list[tuple[list[str | int], str]] = []
    kinds = {link.joint: link.kind for link in scenario.crane.links} | {WINCH: "prismatic"}
    steered = steered_joints(scenario.controllers)
    busy: dict[str, list[tuple[float, float]]] = {}
    for i, move in enumerate(scenario.operations):
        here: list[str | int] = ["operations", i]
        if move.joint not in kinds:
            found.append(([*here, "joint"], f"expected one of {', '.join(kinds)}"))
            continue
        wanted = MOVES[kinds[move.joint]]
        given = [key for keys in MOVES.values() for key in keys if getattr(move, key) is not None]
        if len(given) != 1 or given[0] not in wanted:
            told = " or ".join(wanted)
            found.append((here, f"expected exactly one of {told} for the {kinds[move.joint]} {move.joint}"))
        if wanted[1] in given and move.joint in steered:
            advice = f"expected {wanted[0]}: a controller steers the {move.joint} and takes no positions"
            found.append(([*here, wanted[1]], advice))
        if move.to_s <= move.from_s:
            found.append(([*here, "to_s"], f"expected a time after from_s = {move.from_s:g}"))
        for start, end in busy.setdefault(move.joint, []):
            if move.from_s < end and start < move.to_s:
                found.append((here, f"expected no overlap with another move of {move.joint}, {start:g} to {end:g} s"))
        busy[move.joint].append((move.from_s, move.to_s))
    return found


def sensor_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check that every sensor's period is a whole multiple of the DP's."""
    dp = scenario.dp
    found: list[tuple[list[str | int], str]] = []
    for name in () if dp.sensors.perfect else SENSORS:
        ratio = getattr(dp.sensors, name).period_ms / dp.period_ms
        if ratio < 1.0 or abs(ratio - round(ratio)) > 1e-9:
            advice = f"expected a whole multiple of dp.period_ms = {dp.period_ms:g}"
            found.append((["dp", "sensors", name, "period_ms"], advice))
    return found


def event_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check that events name parts that exist, and say what happens to them."""
    thrusters = [thruster.name for thruster in scenario.vessel.thrusters]
    return [
        (["events", i, key], advice)
        for i, event in enumerate(scenario.events)
        for key, advice in wrong_keys(event, thrusters)
    ]


def zone_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check that forbidden zones protect other thrusters that exist."""
    names = [thruster.name for thruster in scenario.vessel.thrusters]
    return [
        (
            ["vessel", "thrusters", i, "forbidden", k, "protects"],
            f"expected one of {', '.join(name for name in names if name != thruster.name)}",
        )
        for i, thruster in enumerate(scenario.vessel.thrusters)
        for k, zone in enumerate(thruster.forbidden)
        if zone.protects not in names or zone.protects == thruster.name
    ]


def wrong_keys(event: EventConfig, thrusters: Sequence[str]) -> list[tuple[str, str]]:
    """Return the keys of an event that are wrong for its kind, with what is expected of each."""
    kinds: dict[str, tuple[Sequence[str], Sequence[str]]] = {
        "thruster_fault": (thrusters, THRUSTER_FAULTS),
        "sensor_fault": (SENSORS, SENSOR_FAULTS),
    }
    which, faults = kinds.get(event.event, ((), ()))
    found = []
    for key, given, names in (("which", event.which, which), ("fault", event.fault, faults)):
        if (given not in names) if names else (given is not None):
            told = f"one of {', '.join(names)}" if names else "none"
            found.append((key, f"expected {told} with the event {event.event}"))
    if (event.event == "power_limit" or event.fault == "limited") != (event.share is not None):
        found.append(("share", f"expected {'none' if event.share is not None else 'a share'} with {event.event}"))
    return found


def winch_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check the order of the winch's lengths and of the masses on the hook."""
    winch, payload = scenario.winch, scenario.payload
    found: list[tuple[list[str | int], str]] = []
    if not winch.length_min_m <= winch.initial_length_m <= winch.length_max_m:
        limits = f"{winch.length_min_m:g} to {winch.length_max_m:g}"
        found.append((["winch", "initial_length_m"], f"expected a length within the winch's limits, {limits}"))
    if winch.drum.wire_length_m < winch.length_max_m:
        found.append(
            (["winch", "drum", "wire_length_m"], f"expected at least winch.length_max_m = {winch.length_max_m:g}")
        )
    if payload.hook_mass_kg > payload.mass_kg:
        found.append(
            (["payload", "hook_mass_kg"], f"expected no more than payload.mass_kg = {payload.mass_kg:g}, a part of it")
        )
    return found


def weather_problems(scenario: Scenario) -> list[tuple[list[str | int], str]]:
    """Check that each wave system has the keys of its spectrum and no other, and the order of the current's depths."""
    found: list[tuple[list[str | int], str]] = []
    own = set().union(*WAVE_KEYS.values())
    for i, system in enumerate(scenario.environment.waves.systems):
        here: list[str | int] = ["environment", "waves", "systems", i]
        needed = WAVE_KEYS[system.spectrum]
        given = {key for key in own if getattr(system, key) is not None}
        if given != needed:
            found.append((here, f"expected {', '.join(sorted(needed))} with the spectrum {system.spectrum}"))
        if system.spectrum == "regular" and system.spreading_exponent is not None:
            found.append(([*here, "spreading_exponent"], "expected none: a regular wave has one direction"))
    depths = [row[0] for row in scenario.environment.current_profile]
    if depths and (depths != sorted(set(depths)) or depths[0] != 0.0):
        found.append((["environment", "current_profile"], "expected depths that rise from 0, the surface"))
    ballast = scenario.vessel.ballast
    if ballast.mode != "values" and (ballast.heave_n or ballast.roll_n_m or ballast.pitch_n_m):
        found.append((["vessel", "ballast", "mode"], "expected 'values', because values are given"))
    return found
