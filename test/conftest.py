import pytest

FIGURES = pytest.StashKey[list[str]]()


def pytest_configure(config):
    config.stash[FIGURES] = []


@pytest.fixture
def measured(request):
    """Hold a figure against its bar and show both at the end of the session."""

    def hold(what, value, bar, unit=""):
        assert value <= bar, f"{what}: {value:.3g} {unit}, bar {bar:g}"
        request.config.stash[FIGURES].append(f"{what:<86} {value:10.3g} {unit:<6} bar {bar:g}")

    return hold


def pytest_terminal_summary(terminalreporter, config):
    figures = config.stash[FIGURES]
    if figures:
        terminalreporter.section("measured against the bars")
        for line in sorted(figures):
            terminalreporter.write_line(line)
