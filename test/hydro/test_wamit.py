import numpy as np
import pytest
from imported_ships import a_ship, without_fit
from veres_writer import at_origin, origin

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.importing import Particulars
from shipcrane_twin.hydro.wamit import import_wamit

ULEN = 7.0


def particulars(data, **other):
    return Particulars(
        name=data.name,
        cog=data.cog,
        origin=origin(data),
        draught=data.draught,
        length=data.length,
        volume=data.volume,
        centre_of_buoyancy=data.centre_of_buoyancy,
        water_density=data.water_density,
        gravity=data.gravity,
        **other,
    )


def write(stem, data, *, infinite=True, headings=None):
    """WAMIT's numeric output, as its manual has it: two exponents written out, not computed as the reader does."""
    there = at_origin(data)
    rho, g = data.water_density, data.gravity
    lines = []

    def radiation(period, added, damping=None):
        for i in range(6):
            for j in range(6):
                k = 3 + (i >= 3) + (j >= 3)
                line = f"{period:.9E} {i + 1} {j + 1} {added[i, j] / (rho * ULEN**k):.12E}"
                if damping is not None:
                    line += f" {damping[i, j] / (rho * ULEN**k * 2 * np.pi / period):.12E}"
                lines.append(line)

    radiation(-1.0, there.added_mass[0])
    if infinite:
        radiation(0.0, there.added_mass_inf)
    for n, w in enumerate(data.omega):
        radiation(2 * np.pi / w, there.added_mass[n], there.damping[n])
    stem.with_name(stem.name + ".1").write_text("\n".join(lines) + "\n")
    lines.clear()
    for n, w in enumerate(data.omega):
        for heading in np.arange(0.0, 181.0, 15.0) if headings is None else headings:
            mirror = np.array([1, -1, 1, -1, 1, -1]) if heading < 0.0 else np.ones(6)
            for i, value in enumerate(there.excitation[n, int(abs(heading) / 15.0)] * mirror):
                x = value / (rho * g * ULEN ** (2 if i < 3 else 3))
                phase = np.rad2deg(np.angle(x))
                lines.append(
                    f"{2 * np.pi / w:.9E} {heading:.3f} {i + 1} {abs(x):.12E} {phase:.4f} {x.real:.12E} {x.imag:.12E}"
                )
    stem.with_name(stem.name + ".3").write_text("\n".join(lines) + "\n")
    power = {(2, 2): 2, (2, 3): 3, (2, 4): 3, (3, 3): 4, (3, 4): 4, (3, 5): 4, (4, 4): 4, (4, 5): 4}
    power |= {(j, i): value for (i, j), value in power.items()}
    stem.with_name(stem.name + ".hst").write_text(
        "".join(
            f" {i + 1} {j + 1} {there.restoring[i, j] / (rho * g * ULEN ** power.get((i, j), 2)):.12E}\n"
            for i in range(6)
            for j in range(6)
        )
    )
    return stem


@pytest.fixture(scope="module")
def data():
    return a_ship(np.linspace(0.15, 3.0, 12))


@pytest.fixture(scope="module")
def stem(tmp_path_factory, data):
    return write(tmp_path_factory.mktemp("wamit") / "box.v2", data)


def test_a_known_ship_comes_back_whole(stem, data):
    back = import_wamit(stem, particulars(data), ulen=ULEN, fit=without_fit)
    np.testing.assert_allclose(back.direction, data.direction, atol=1e-9)
    for name in ("omega", "restoring", "added_mass", "damping", "added_mass_inf", "excitation"):
        expected = getattr(data, name)
        np.testing.assert_allclose(getattr(back, name), expected, atol=1e-7 * np.abs(expected).max(), err_msg=name)
    assert "from the file" in back.source


def test_headings_of_the_other_side(tmp_path, data):
    stem = write(tmp_path / "box", data, headings=-np.arange(0.0, 181.0, 15.0))
    back = import_wamit(stem, particulars(data), ulen=ULEN, fit=without_fit)
    np.testing.assert_allclose(back.excitation, data.excitation, atol=1e-7 * np.abs(data.excitation).max())


def test_a_missing_infinite_frequency_is_found_and_said(tmp_path):
    data = a_ship(np.linspace(0.1, 6.0, 60), np.deg2rad(np.arange(0.0, 181.0, 15.0)))
    stem = write(tmp_path / "box", data, infinite=False)
    back = import_wamit(stem, particulars(data), ulen=ULEN, fit=without_fit)
    assert "(Ogilvie)" in back.source
    scale = np.sqrt(np.outer(np.diag(data.added_mass_inf), np.diag(data.added_mass_inf)))
    np.testing.assert_allclose(back.added_mass_inf / scale, data.added_mass_inf / scale, atol=0.05)


def test_wrong_length_scale_does_not_pass_as_a_ship(stem, data):
    with pytest.raises(ConfigError, match="expected SI units"):
        import_wamit(stem, particulars(data), ulen=7.0 * ULEN, fit=without_fit)


@pytest.mark.parametrize(
    ("suffix", "row", "change", "told"),
    [
        (".1", 50, lambda words: words[:3], r"v2.1:51: 3 columns, expected 4 or 5"),
        (".1", 50, lambda words: [words[0], "7", *words[2:]], r"v2.1:51: mode 7, expected 1 to 6"),
        (".1", 50, lambda words: ["x", *words[1:]], r"v2.1:51: 'x .*expected numbers only"),
        (
            ".3",
            9,
            lambda words: [*words[:5], words[3], words[3]],
            r"v2.3:10: modulus .* expected columns period, heading",
        ),
        (".3", 9, lambda words: ["1.234", *words[1:]], r"v2.3:10: period 1.234 s is not in the .1 file"),
        (".3", 9, lambda words: [], r"v2.3: no load of mode 4 at period .* heading 15"),
        (".hst", 3, lambda words: words[:2], r"hst:4: 2 columns, expected 3"),
    ],
)
def test_a_broken_file_is_named_with_its_remedy(tmp_path, stem, data, suffix, row, change, told):
    for end in (".1", ".3", ".hst"):
        lines = stem.with_name(stem.name + end).read_text().splitlines()
        if end == suffix:
            lines[row] = " ".join(change(lines[row].split()))
        (tmp_path / (stem.name + end)).write_text("\n".join(lines))
    with pytest.raises(ConfigError, match=told):
        import_wamit(tmp_path / stem.name, particulars(data), ulen=ULEN, fit=without_fit)


def test_missing_and_empty_files_are_named(tmp_path, data):
    with pytest.raises(ConfigError, match=r"none.1: cannot be read .* path without suffix"):
        import_wamit(tmp_path / "none", particulars(data), fit=without_fit)
    (tmp_path / "none.1").write_text("")
    with pytest.raises(ConfigError, match=r"none.1: is empty"):
        import_wamit(tmp_path / "none", particulars(data), fit=without_fit)
