import pytest

FIGURE = "measured against its bar"


def starts_graphs(file):
    """Whether the tests of a file start graphs of processes: never two of them at once."""
    return "integration/" in file or file.endswith("test_msg_docs.py")


def pytest_collection_modifyitems(items):
    """Put the graphs first: where several processes share the tests, theirs has the most to do."""
    items.sort(key=lambda item: not starts_graphs(item.nodeid.partition("::")[0]))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Let several processes share the tests by file, and one have all that start graphs."""
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            file = nodeid.partition("::")[0]
            return "graphs" if starts_graphs(file) else file

    return ByFile(config, log)


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
