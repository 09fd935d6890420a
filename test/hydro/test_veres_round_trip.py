import numpy as np
import pytest
from imported_ships import a_ship, mass_of, without_fit
from veres_writer import at_origin, folder_of, transfer_file

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.rao import raos
from shipcrane_twin.hydro.veres import import_veres, read_motions
from shipcrane_twin.hydro.veres_extras import read_extras


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    data = a_ship(np.linspace(0.15, 3.0, 12))
    motions = raos(data, mass_of(data))
    return folder_of(tmp_path_factory.mktemp("veres"), data, mass_of(data), motions), data, motions


def edited(written, tmp_path, file, old, new, count=-1):
    folder = tmp_path
    for source in written[0].iterdir():
        text = source.read_text()
        if source.name == file:
            assert old in text
            text = text.replace(old, new, count)
        (folder / source.name).write_text(text)
    return folder


def test_a_known_ship_comes_back_whole(written):
    folder, data, motions = written
    back = import_veres(folder, vcb=1.5, fit=without_fit)
    assert back.name == "Box"
    np.testing.assert_allclose(back.cog, data.cog, atol=1e-9)
    assert back.volume == pytest.approx(data.volume)
    np.testing.assert_allclose(np.rad2deg(back.direction), np.rad2deg(data.direction), atol=1e-9)
    for name in ("omega", "restoring", "added_mass", "damping", "excitation", "drift"):
        expected = getattr(data, name)
        np.testing.assert_allclose(getattr(back, name), expected, atol=2e-9 * np.abs(expected).max(), err_msg=name)
    np.testing.assert_allclose(read_motions(folder, back), motions, atol=1e-9)
    np.testing.assert_allclose(read_extras(folder).mass, mass_of(data), atol=1.0)
    assert read_extras(folder).quadratic_roll.tolist() == [[0.0, 2.5e5]]


def test_version_1_of_re7_has_one_set_of_matrices(tmp_path, written):
    _, data, motions = written
    back = import_veres(folder_of(tmp_path, data, mass_of(data), motions, version=1), vcb=1.5, fit=without_fit)
    np.testing.assert_allclose(back.added_mass, data.added_mass, atol=1e-3)


def test_headings_of_one_side_are_enough(tmp_path, written):
    folder, data, motions = written
    whole = import_veres(folder, vcb=1.5, fit=without_fit)
    folder_of(tmp_path, data, mass_of(data), motions)
    half = transfer_file(
        "WAVE EXCITATION FORCE", data, at_origin(data).excitation, headings=np.arange(0.0, 181.0, 15.0)
    )
    (tmp_path / "input.re8").write_text(half)
    np.testing.assert_allclose(import_veres(tmp_path, vcb=1.5, fit=without_fit).excitation, whole.excitation, atol=1e-3)


def test_motions_are_absent_where_no_file_holds_them(tmp_path, written):
    folder, data, motions = written
    folder_of(tmp_path, data, mass_of(data), motions)
    (tmp_path / "input.re1").unlink()
    assert read_motions(tmp_path, import_veres(folder, vcb=1.5, fit=without_fit)) is None


def test_drift_is_zero_and_said_so_without_re2(tmp_path, written):
    _, data, motions = written
    folder_of(tmp_path, data, mass_of(data), motions)
    (tmp_path / "input.re2").unlink()
    back = import_veres(tmp_path, vcb=1.5, fit=without_fit)
    assert not back.drift.any()
    assert "no input.re2: drift is zero" in back.source


@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        ("input.re8", "WAVE EXCITATION", "MOTION TRANSFER", r"re8:1: the first line is 'MOTION.*expected 'WAVE EXC"),
        (
            "input.re8",
            " 2.000000000000E+00 0.0",
            " 2.0000000x 0.0",
            r"re8:11: ' *2.0000000x .* is not a line of numbers",
        ),
        ("input.re8", "1.025000000000E+03", "1.025000000000E+00", r"density 1.025 .*expected about 1025 .*SI units"),
        (
            "input.re8",
            " 2 24 12 6",
            " 2 24 13 6",
            r"re8: \d+ numbers after line 10, expected \d+ for 2 speeds, 24 headings and 13",
        ),
        ("input.re8", " 2 24 12 6", " 2 24 12 3", r"re8:10: .*expected the counts .* 6 degrees"),
        ("input.re8", " 0.00\n", " nan\n", r"re8: number \d+ of the table is not finite"),
        ("input.re7", "HYDRODYNAMIC", "HYDROSTATIC", r"re7:1: the first line is"),
        ("input.re7", " 0.1500000000\n", " 0.1600000000\n", r"re7: its frequencies are not those of re8"),
        ("input.re2", " 0.1500", " 0.1700", r"re2: headings or frequencies are not those of input.re8"),
    ],
)
def test_a_broken_file_is_named_with_its_remedy(tmp_path, written, file, old, new, told):
    folder = edited(written, tmp_path, file, old, new)
    with pytest.raises(ConfigError, match=told):
        import_veres(folder, vcb=1.5, fit=without_fit)


def test_a_cut_file_is_named(tmp_path, written):
    folder = edited(written, tmp_path, "input.re7", "HYDRO", "HYDRO")
    text = (folder / "input.re7").read_text()
    (folder / "input.re7").write_text(text[: len(text) // 2])
    with pytest.raises(ConfigError, match=r"re7: \d+ numbers .* cut off"):
        import_veres(folder, vcb=1.5, fit=without_fit)


def test_a_file_without_zero_speed_is_refused(tmp_path, written):
    folder = edited(
        written, tmp_path, "input.re8", " 0.000000000000E+00 0.000000000000E+00 0", " 3.0 0.000000000000E+00 0"
    )
    with pytest.raises(ConfigError, match=r"speeds are \[2.0, 3.0\] m/s, expected one of 0"):
        import_veres(folder, vcb=1.5, fit=without_fit)


def test_missing_files_are_named(tmp_path, written):
    with pytest.raises(ConfigError, match=r"input.re8: cannot be read \(No such file"):
        import_veres(tmp_path, vcb=1.5)
    (tmp_path / "input.re8").write_text((written[0] / "input.re8").read_text())
    with pytest.raises(ConfigError, match=r"neither retfun.re10 nor input.re7"):
        import_veres(tmp_path, vcb=1.5)
    (tmp_path / "input.re7").write_text((written[0] / "input.re7").read_text())
    with pytest.raises(ConfigError, match=r"names the centre of buoyancy; give its height"):
        import_veres(tmp_path)


def test_the_centre_of_buoyancy_is_read_where_a_file_has_it(tmp_path, written):
    folder = edited(written, tmp_path, "input.re7", "HYDRO", "HYDRO")
    (folder / "input.hyd").write_text("Vertical center of bouyancy, KB        1.517*\n")
    assert import_veres(folder, fit=without_fit).centre_of_buoyancy[2] == 1.517
    (folder / "vesselcoeff.xml").write_text(
        "<r><scalar><name>Vertical_centre_of_buoyancy</name><data>1.6</data></scalar></r>"
    )
    assert import_veres(folder, fit=without_fit).centre_of_buoyancy[2] == 1.6
    (folder / "vesselcoeff.xml").write_text("<r><scalar>")
    with pytest.raises(ConfigError, match=r"vesselcoeff.xml: is not XML"):
        import_veres(folder, fit=without_fit)


def test_a_line_of_derivatives_without_a_number_is_named(tmp_path, written):
    folder = edited(written, tmp_path, "input.re7", "HYDRO", "HYDRO")
    (folder / "any.mancoeff").write_text("'comment\nXuu=-2100\nYvv=x1\n")
    with pytest.raises(ConfigError, match=r"any.mancoeff:3: 'Yvv=x1', expected name=number"):
        read_extras(folder)
