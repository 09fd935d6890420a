from dataclasses import replace

import numpy as np
import pytest
from synthetic import HOT_MS, TELEMETRY_MS, Lift, write_run

from shipcrane_twin.record.read import read_signals
from shipcrane_twin.report.summary import find_gaps, summarise

HALF = np.sqrt(0.5)  # standard deviation of a sine of amplitude 1


@pytest.fixture(scope="module")
def run(made_up):
    lift, path = made_up
    return lift, read_signals(path / "bag")


def gaps_of(signals, end_s):
    return find_gaps(signals, end_s=end_s, macro_step_ms=HOT_MS, telemetry_period_ms=TELEMETRY_MS)


def test_statistics_equal_the_closed_forms(run):
    lift, signals = run
    stats = summarise(signals, lift.scenario())
    for key, (mean, amplitude, _) in {
        "roll_deg": lift.roll_deg,
        "pitch_deg": lift.pitch_deg,
        "heave_m": lift.heave_m,
    }.items():
        found = stats[key]
        assert found["mean"] == pytest.approx(mean, abs=1e-9)
        assert found["std"] == pytest.approx(amplitude * HALF, rel=1e-3)
        assert found["min"] == pytest.approx(mean - amplitude, abs=1e-4)
        assert found["max"] == pytest.approx(mean + amplitude, abs=1e-4)
    error = np.hypot(*lift.position_error_m)
    assert stats["position_error_m"] == pytest.approx({"rms": error, "max": error}, rel=1e-9)
    mean, amplitude, _ = lift.tension_n
    tension = {"mean": mean, "max": mean + amplitude, "min": mean - amplitude}
    assert stats["wire_tension_kn"] == pytest.approx({k: v / 1000 for k, v in tension.items()}, rel=1e-6)
    sway = {"rms": lift.sway_deg * HALF, "max": lift.sway_deg}
    assert stats["payload_sway_deg"] == pytest.approx(sway, rel=1e-3)
    assert stats["messages"] == dict(signals.counts)


def test_position_error_counts_only_after_dp_has_settled(run):
    lift, signals = run
    scenario = lift.scenario()
    scenario["dp"] |= {"enabled_at_s": 10.0, "settled_after_s": lift.duration_s - 10.0}
    assert summarise(signals, scenario)["position_error_m"] is not None
    scenario["dp"]["settled_after_s"] += 0.01
    assert summarise(signals, scenario)["position_error_m"] is None


def test_sway_of_a_load_off_the_wire_does_not_count(run):
    lift, signals = run
    wire = signals.series["/payload/wire_wrench"]
    slack = replace(wire, values=wire.values * (wire.time_s < 1.0)[:, None])
    series = dict(signals.series) | {"/payload/wire_wrench": slack}
    stats = summarise(replace(signals, series=series), lift.scenario())
    first = lift.sway_deg * np.sin(2 * np.pi / 2.5 * 0.62)  # the peak of the first second
    assert stats["payload_sway_deg"]["max"] == pytest.approx(first, rel=1e-3)
    assert stats["wire_tension_kn"]["min"] == 0.0


def test_a_bag_without_a_topic_gives_none_for_its_numbers(run):
    lift, signals = run
    stats = summarise(replace(signals, series={}), lift.scenario())
    numbers = {key: value for key, value in stats.items() if key != "messages"}
    assert set(numbers.values()) == {None}


def test_a_complete_bag_has_no_gaps(run):
    lift, signals = run
    assert gaps_of(signals, lift.duration_s) == []


def test_missing_messages_are_found_by_topic_and_time(tmp_path):
    drop = {"/crane/tip": {150}, "/winch/joint_states": {0, 7}, "/payload/odom": {200}}
    signals = read_signals(write_run(tmp_path / "run", Lift(duration_s=4.0), drop) / "bag")
    found = {gap.topic: (gap.expected, gap.found, gap.first_s) for gap in gaps_of(signals, 4.0)}
    assert found == {
        "/crane/tip": (201, 200, pytest.approx(3.0)),
        "/winch/joint_states": (41, 39, 0.0),
        "/payload/odom": (201, 200, pytest.approx(4.0)),
    }
    texts = [str(gap) for gap in gaps_of(signals, 4.0)]
    assert "/crane/tip: 200 messages instead of 201, first missing at t = 3 s" in texts


def test_a_message_at_a_wrong_time_is_a_gap_although_the_count_is_right(run):
    lift, signals = run
    tip = signals.series["/crane/tip"]
    stamps = tip.stamp_ns.copy()
    stamps[5] += 1
    series = dict(signals.series) | {"/crane/tip": replace(tip, stamp_ns=stamps)}
    (gap,) = gaps_of(replace(signals, series=series), lift.duration_s)
    assert (gap.topic, gap.expected - gap.found, gap.first_s) == ("/crane/tip", 0, pytest.approx(0.1))


def test_too_many_messages_and_a_run_cut_early_are_told(run):
    lift, signals = run
    early = gaps_of(signals, lift.duration_s - 1.0)
    assert {gap.first_s for gap in early} == {None}
    assert "nobody expects" in str(early[0])
    late = gaps_of(signals, lift.duration_s + 1.0)
    assert len(late) == len(early) == len(signals.counts) - 1  # the sea comes once
    assert min(gap.first_s for gap in late) > lift.duration_s
