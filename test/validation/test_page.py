"""The page: every figure in it, what misses named, pictures beside it."""

import pytest
from imported_ships import shipx_folder
from validation_runs import SMALL

from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.validation.checks import all_sections
from shipcrane_twin.validation.page import Section, held, page_text, table, write_page


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    told = []
    sections, source = all_sections(folder / "pictures", progress=told.append, extent=SMALL)
    return folder, sections, write_page(sections, "./twin hydro validate", source, folder), told


def test_every_figure_and_every_picture_stands_in_the_page(written):
    folder, sections, path, told = written
    text = path.read_text(encoding="utf-8")
    rows = [row for section in sections for row in section.rows]
    assert len(rows) > 30
    for row in rows:
        assert f"| {row.what} |" in text
    pictures = sorted(p.relative_to(folder).as_posix() for p in (folder / "pictures").iterdir())
    assert len(pictures) == 12
    for picture in pictures:
        assert f"]({picture})" in text
    assert {"mean drift", "sea"} <= set(told)
    assert "Capytaine 3" in text


def test_without_veres_and_panels_the_page_says_what_is_left_out(written):
    _, sections, path, _ = written
    text = path.read_text(encoding="utf-8")
    assert "./twin hydro validate --veres FOLDER" in text.replace("\n", " ")
    assert "hydro validate --panels" in text.replace("\n", " ")
    assert [section.title for section in sections if not section.rows] == ["Panels", "VERES"]
    assert "| [Panels](#panels) | left out |" in text


def test_with_veres_the_comparisons_are_in(tmp_path, tmp_path_factory):
    folder = shipx_folder(tmp_path_factory)
    sections, source = all_sections(tmp_path / "pictures", veres_folder=folder, extent=SMALL)
    rows = {section.title: section.rows for section in sections}
    assert len([row for row in rows["Against VERES"] if row.bar]) == 4 * 6 + 3 + 3
    assert all(row.holds for row in [*rows["Against VERES"], *rows["Imported VERES model"]])
    assert any(row.what.startswith("A55") for row in rows["Where strip theory differs"])
    text = page_text(sections, "validate", source, tmp_path)
    for row in (row for of in rows.values() for row in of if not row.what.endswith(", with phase")):
        assert f"| {row.what} |" in text


def test_what_misses_is_named_and_counted(tmp_path):
    good, bad = Row("one thing", 0.019, 0.02, "", "note"), Row("another", 3.0, 2.0, "of 8", "why")
    sections = [Section("Part one", "Words.", [good, bad, Row("told", 0.5, None)], [])]
    assert held(sections) == (1, 2)
    text = page_text(sections, "cmd", "source", tmp_path)
    assert "- another: 3 of 8 of 2 of 8 (why)" in text
    assert "- one thing: 1.90 % of 2.00 %" in text  # a thin margin
    assert "| another | 3 of 8 | 2 of 8 | **MISSED** | why |" in text
    assert "| told | 50.00 % |  |  |  |" in text
    assert "| [Part one](#part-one) | 1 of 2 |" in text


def test_figures_with_phase_stand_beside_those_of_the_amplitude():
    rows = [Row("F2", 0.1, 0.2, "", "a"), Row("F2, with phase", 0.3, None), Row("F3", 0.1, None)]
    assert table(rows)[2:] == [
        "| F2 | 10.00 % | 20.00 % | yes | 30.00 % | a |",
        "| F3 | 10.00 % |  |  |  |  |",
    ]
