import pytest

FIGURE = "measured against its bar"


def pytest_collection_modifyitems(items):
    """Where several processes share the tests, keep a file's together, and all that start graphs in one process."""
    for item in items:
        graph = item.get_closest_marker("ros") is not None
        item.add_marker(pytest.mark.xdist_group("graphs" if graph else item.path.name))
    items.sort(key=lambda item: item.get_closest_marker("ros") is None)  # the longest group first


@pytest.fixture
def measured(request):
    """Hold a figure against its bar and show both at the end of the session."""

    def hold(what, value, bar, unit=""):
        assert value <= bar, f"{what}: {value:.3g} {unit}, bar {bar:g}"
        request.node.user_properties.append((FIGURE, f"{what:<86} {value:10.3g} {unit:<6} bar {bar:g}"))

    return hold


def pytest_terminal_summary(terminalreporter):
    figures = [
        line
        for report in terminalreporter.getreports("passed") + terminalreporter.getreports("failed")
        for key, line in report.user_properties
        if key == FIGURE
    ]
    if figures:
        terminalreporter.section(FIGURE)
        for line in sorted(figures):
            terminalreporter.write_line(line)
