from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.text import Text
from synthetic import Lift, write_bag

from shipcrane_twin.record.read import read_signals
from shipcrane_twin.report.figures import make_figures, png_bytes
from shipcrane_twin.report.style import decimate, operations_of

ALWAYS = ["motions", "joints", "tip_payload", "wire", "base_wrench", "track"]


@pytest.fixture(scope="module")
def run(made_up):
    lift, path = made_up
    return lift.scenario(), read_signals(path / "bag")


@pytest.fixture(scope="module")
def plots(run):
    scenario, signals = run
    return {plot.name: plot for plot in make_figures(signals, scenario)}


def lines_of(plot):
    return [line for axes in plot.figure.axes for line in axes.lines if len(line.get_xdata()) > 2]


def first(count, series):
    return replace(series, stamp_ns=series.stamp_ns[:count], values=series.values[:count])


@settings(deadline=None)  # the machine may be busy
@given(st.integers(0, 999), st.integers(1, 5000), st.sampled_from([4, 50, 400]))
def test_decimation_keeps_ends_and_peaks_and_stays_small(seed, count, limit):
    values = np.random.default_rng(seed).normal(size=count)
    time_s = np.arange(count) * 0.02
    short_s, short = decimate(time_s, values, limit)
    assert len(short) <= limit
    assert (short.min(), short.max()) == (values.min(), values.max())
    assert (short_s[0], short_s[-1]) == (time_s[0], time_s[-1])
    assert (np.diff(short_s) > 0).all()
    np.testing.assert_array_equal(short, values[np.searchsorted(time_s, short_s)])


def test_all_figures_are_drawn_and_the_environment_only_if_there_is_one(plots, tmp_path):
    assert list(plots) == ALWAYS
    lift = Lift(duration_s=4.0, wind_speed=3.0)
    signals = read_signals(write_bag(tmp_path / "bag", lift.topics()))
    windy = {plot.name: plot for plot in make_figures(signals, lift.scenario())}
    assert list(windy) == [*ALWAYS, "environment"]
    speed, direction = (line.get_ydata() for line in lines_of(windy["environment"]))
    np.testing.assert_allclose(speed, 3.0)
    np.testing.assert_allclose(direction, 90.0)  # blows to the east


def test_the_sea_is_drawn_where_the_ship_is_and_only_if_there_is_one(run, plots):
    scenario, signals = run
    assert "sea" not in plots
    wave = {"amplitude": 0.5, "omega": 0.8, "number_x": 0.03, "number_y": -0.05, "phase": 0.4}
    sea = {"/environment/sea_state": {name: np.array([value]) for name, value in wave.items()}}
    in_waves = dict(scenario) | {"environment": {"waves": {"ramp_s": 0.0}}}
    plot = {plot.name: plot for plot in make_figures(replace(signals, clouds=sea), in_waves)}["sea"]
    elevation, heave = lines_of(plot)[:2]
    t = elevation.get_xdata()
    # the ship of the synthetic lift stays at 10.3 m north and 4.6 m east
    expected = 0.5 * np.cos(0.8 * t - 0.03 * 4.6 + 0.05 * 10.3 + 0.4)
    np.testing.assert_allclose(elevation.get_ydata(), expected, atol=1e-9)
    assert heave.get_ydata().max() == pytest.approx(plots["motions"].figure.axes[2].lines[0].get_ydata().max())
    assert "Hs 1.41 m of 1 components" in plot.caption


def test_no_text_is_smaller_than_nine_points(plots):
    for plot in plots.values():
        png_bytes(plot.figure)  # ticks get their labels when drawn
        sizes = [text.get_fontsize() for text in plot.figure.findobj(Text) if text.get_text()]
        assert min(sizes) >= 9.0, plot.name


def test_every_axis_says_its_unit_and_signs_are_named(plots):
    for plot in plots.values():
        for axes in plot.figure.axes:
            if axes.get_ylabel() and axes.get_label() != "<colorbar>":
                assert "[" in axes.get_ylabel(), plot.name
    text = " ".join(axes.get_ylabel().replace("\n", " ") for p in plots.values() for axes in p.figure.axes)
    for words in ("starboard down [deg]", "bow up [deg]", "from north [deg]", "[kN m]", "positive out [m]"):
        assert words in text


def test_curves_show_the_signals(run, plots):
    _, signals = run
    lift = Lift(duration_s=40.0)
    roll, pitch, heave = lines_of(plots["motions"])
    for line, part in ((roll, lift.roll_deg), (pitch, lift.pitch_deg), (heave, lift.heave_m)):
        np.testing.assert_allclose(line.get_ydata(), lift.wave(part, line.get_xdata()), atol=1e-9)
    slew, *_, telescope = lines_of(plots["joints"])
    assert (slew.get_ydata().min(), slew.get_ydata().max()) == pytest.approx(np.rad2deg([-1.2, 1.2]))
    np.testing.assert_allclose(telescope.get_ydata(), 2.0)
    tension = lines_of(plots["wire"])[0]
    np.testing.assert_allclose(tension.get_ydata(), lift.wave(lift.tension_n, tension.get_xdata()) / 1000)
    heading, error = lines_of(plots["track"])[-2:]
    np.testing.assert_allclose(heading.get_ydata(), 30.0)
    np.testing.assert_allclose(error.get_ydata(), 0.5)
    tip, payload = lines_of(plots["tip_payload"])[:2]
    series = signals.series
    np.testing.assert_allclose(tip.get_ydata(), series["/crane/tip"].values[:, 1])
    np.testing.assert_allclose(payload.get_ydata(), series["/payload/odom"].values[:, 1])


def test_a_figure_without_its_topic_is_left_out(run):
    scenario, signals = run
    series = {name: s for name, s in signals.series.items() if name not in ("/crane/tip", "/vessel/odom")}
    names = [plot.name for plot in make_figures(replace(signals, series=series, joints={}), scenario)]
    assert names == ["wire", "base_wrench"]
    nothing = {name: first(0, series) for name, series in signals.series.items()}
    assert make_figures(replace(signals, series=nothing, joints={}), scenario) == []


def test_a_run_of_a_single_moment_can_be_drawn(run):
    """A run that was stopped at t = 0."""
    scenario, signals = run
    series = {name: first(1, series) for name, series in signals.series.items()}
    winch = replace(signals.joints["/winch/joint_states"], names=(), position=np.empty((0, 0)))
    joints = dict(signals.joints) | {"/winch/joint_states": winch}
    for plot in make_figures(replace(signals, series=series, joints=joints), scenario):
        assert png_bytes(plot.figure).startswith(b"\x89PNG")


def test_a_run_that_ended_early_shows_only_what_it_reached(run):
    scenario, signals = run
    moves = [{"label": name, "from_s": a, "to_s": b} for name, a, b in (("lift", 10, 20), ("slew", 30, 60))]
    late = {"label": "land", "from_s": 50, "to_s": 60}
    plot = make_figures(signals, scenario | {"operations": [*moves, late], "events": None})[0]
    assert {axes.get_xlim() for axes in plot.figure.axes} == {(0.0, 40.0)}
    texts = " ".join(text.get_text() for text in plot.figure.findobj(Text))
    assert "slew" in texts
    assert "land" not in texts


def test_operations_and_events_come_in_order_with_their_tags():
    scenario = {
        "operations": [
            {"label": "4 slew to land", "joint": "slew", "from_s": 364.0, "to_s": 441.0},
            {"label": "1 lift", "joint": "boom", "from_s": 220.0, "to_s": 242.0},
            {"label": "1 lift", "joint": "knuckle", "from_s": 225.0, "to_s": 242.0},
        ],
        "events": [{"label": "5 off-load", "at_s": 445.0, "event": "release_payload"}],
    }
    moves = operations_of(scenario)
    assert [(m.tag, m.label, m.from_s, m.to_s) for m in moves] == [
        ("1", "lift", 220.0, 242.0),
        ("1", "lift", 225.0, 242.0),
        ("4", "slew to land", 364.0, 441.0),
        ("5", "off-load", 445.0, 445.0),
    ]
    unnumbered = operations_of({"operations": [{"joint": "slew", "from_s": 2, "to_s": 3}], "events": None})
    assert [(m.tag, m.label) for m in unnumbered] == [("1", "slew")]


def test_equal_figures_give_equal_bytes(run):
    scenario, signals = run
    one, other = (make_figures(signals, scenario)[0] for _ in range(2))
    assert png_bytes(one.figure) == png_bytes(other.figure)
