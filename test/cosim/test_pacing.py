"""What the clock decides: how far it may go, who is silent, and when the next step is due."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from shipcrane_twin.cosim.coupling import CHAIN, SCHEMES
from shipcrane_twin.cosim.pacing import RECORDER_LEAD_STEPS, Lockstep, Pace, progress_of

SCHEME = SCHEMES["in_turn+inertia"]
steps = st.integers(-1, 30)


def lockstep(run_ahead=4, recorded=False, last=1000, announced=-1, recorded_to=-1, **done):
    out = Lockstep(SCHEME, last, run_ahead, recorded, announced=announced, recorded_to=recorded_to)
    out.done |= done
    return out


def all_at(step):
    return dict.fromkeys(CHAIN, step)


@given(done=st.tuples(*[steps] * len(CHAIN)), run_ahead=st.integers(1, 10))
def test_clock_leads_the_slowest_by_no_more_than_run_ahead(done, run_ahead):
    state = lockstep(run_ahead, **dict(zip(CHAIN, done, strict=True)))
    assert state.may_announce() == min(done) + run_ahead


def test_clock_never_passes_the_end_and_never_goes_back():
    assert lockstep(last=10, **all_at(9)).may_announce() == 10
    assert lockstep(announced=8, **all_at(2)).may_announce() == 8


def test_clock_waits_for_the_recorder():
    state = lockstep(recorded=True, recorded_to=50, **all_at(50 + RECORDER_LEAD_STEPS))
    assert state.may_announce() == 50 + RECORDER_LEAD_STEPS
    state.recorded_to += 10
    assert state.may_announce() == 60 + RECORDER_LEAD_STEPS - 6  # now the slowest participant holds it again


def test_recorder_counts_only_where_there_is_one():
    assert lockstep(recorded=False, **all_at(900)).may_announce() == 904


@pytest.mark.parametrize(
    ("recorded", "recorded_to", "finished"), [(False, -1, True), (True, 999, False), (True, 1000, True)]
)
def test_run_is_finished_when_all_is_done_and_recorded(recorded, recorded_to, finished):
    assert lockstep(recorded=recorded, recorded_to=recorded_to, **all_at(1000)).finished is finished
    assert not lockstep(recorded=recorded, recorded_to=recorded_to, **all_at(999)).finished


@pytest.mark.parametrize("name", CHAIN)
def test_the_one_that_stands_still_is_named_alone(name):
    state = lockstep(announced=20)
    state.done |= all_at(15)
    for _ in range(50):  # everybody else goes on as far as the inputs and the clock allow
        for other in CHAIN:
            if other != name and state.done[other] < 20 and state.can_step(other, state.done[other] + 1):
                state.done[other] += 1
    assert state.silent() == [name]


def test_all_are_silent_before_the_first_step():
    assert lockstep(announced=0).silent() == list(CHAIN)


def test_nobody_is_silent_when_all_that_was_announced_is_done():
    assert lockstep(announced=7, **all_at(7)).silent() == []


def test_recorder_is_named_when_only_it_is_behind():
    state = lockstep(recorded=True, announced=300, recorded_to=100, **all_at(300))
    assert state.silent() == ["recorder"]
    state.recorded_to = 300
    assert state.silent() == []


def test_first_step_needs_no_inputs_and_later_ones_their_neighbours():
    state = lockstep()
    assert all(state.can_step(name, 0) for name in CHAIN)
    state.done |= all_at(0)
    assert [name for name in CHAIN if state.can_step(name, 1)] == ["environment"]
    state.done["environment"] = 1
    assert state.can_step("vessel", 1)
    assert not state.can_step("crane", 1)


@given(wall=st.floats(0.0, 100.0), allowed=st.integers(0, 10_000), speed=st.sampled_from([0.5, 1.0, 10.0]))
def test_paced_clock_announces_what_is_due_and_no_more(wall, allowed, speed):
    pace = Pace(step_s=0.02, speed=speed)
    pace.restart(0, 0.0)
    due = pace.due(0, allowed, wall)
    assert 0 <= due <= allowed
    assert due * 0.02 <= wall * speed + 1e-9
    assert due == allowed or (due + 1) * 0.02 > wall * speed - 1e-9


def test_full_speed_takes_all_that_is_allowed():
    assert Pace(step_s=0.02, speed=0.0).due(3, 77, 0.0) == 77


def test_paused_clock_stands_and_single_steps_go_one_by_one():
    pace = Pace(step_s=0.02, speed=0.0, paused=True)
    assert pace.due(5, 100, 1.0) == 5
    pace.single_steps = 2
    assert pace.due(5, 100, 2.0) == 7
    assert pace.due(7, 100, 3.0) == 7


def test_single_steps_wait_until_they_are_allowed():
    pace = Pace(step_s=0.02, speed=0.0, paused=True, single_steps=3)
    assert pace.due(5, 6, 1.0) == 6
    assert pace.due(6, 6, 2.0) == 6
    assert pace.due(6, 100, 3.0) == 8


def test_time_that_passed_in_a_pause_is_not_caught_up():
    pace = Pace(step_s=0.02, speed=1.0)
    pace.restart(0, 0.0)
    assert pace.due(0, 1000, 1.01) == 50
    pace.paused = True
    assert pace.due(50, 1000, 100.0) == 50
    pace.paused = False
    assert pace.due(50, 1000, 100.001) == 50
    assert pace.due(50, 1000, 100.05) == 52


def test_wait_lasts_until_the_next_step_is_due():
    pace = Pace(step_s=0.02, speed=2.0)
    pace.restart(10, 5.0)
    assert pace.wait_s(10, 5.004, 1.0) == pytest.approx(0.006)
    assert pace.wait_s(10, 6.0, 1.0) == 0.0
    assert pace.wait_s(10, 5.0, 0.001) == 0.001
    assert Pace(step_s=0.02, speed=0.0).wait_s(3, 0.0, 0.5) == 0.5


def test_progress_is_the_latest_stamp_on_the_grid():
    assert progress_of({0: 1, 20_000_000: 1, 40_000_000: 1}, 20_000_000) == 2
    assert progress_of({20_000_000: 1, 50_000_000: 1}, 20_000_000) == 1  # the second is somebody else's
    assert progress_of({}, 20_000_000) == -1
