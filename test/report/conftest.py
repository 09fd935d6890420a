"""One made-up run for all tests of the report."""

import pytest
from synthetic import Lift, write_run


@pytest.fixture(scope="session")
def made_up(tmp_path_factory):
    """A complete run directory that tests only read: (Lift, path)."""
    lift = Lift(duration_s=40.0)
    return lift, write_run(tmp_path_factory.mktemp("made_up") / "run", lift)
