"""The project's own ship against VERES's model of it: the bars of the validation page."""

from pathlib import Path

import pytest
from imported_ships import shipx_folder, without_fit

from shipcrane_twin.hydro.compare import compare_with_veres
from shipcrane_twin.hydro.database import moved
from shipcrane_twin.hydro.files import load_database
from shipcrane_twin.hydro.veres import import_veres
from shipcrane_twin.hydro.veres_extras import read_extras

OURS = Path(__file__).resolve().parents[2] / "config/vessels/gunnerus/hydro.nc"


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    folder = shipx_folder(tmp_path_factory)
    veres = import_veres(folder, fit=without_fit)
    return compare_with_veres(moved(load_database(OURS), veres.cog), veres, read_extras(folder).mass)


def test_loads_added_mass_and_periods_keep_their_bars(rows, measured):
    judged = [row for row in rows if row.bar is not None]
    assert len(judged) == 4 * 6 + 3 + 3
    for row in judged:
        measured(row.what, row.value, row.bar, row.unit)


def test_phases_agree_in_long_waves(rows):
    """With phase there is no bar: strip theory's pitch moment turns. In waves of 20 s all four agree to 15 %."""
    found = {row.what: row.value for row in rows}
    for load in ("F2 (sway)", "F3 (heave)", "F4 (roll)", "F5 (pitch)"):
        assert found[f"{load} against VERES at 20 s, with phase"] < 0.15
