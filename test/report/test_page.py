import base64
import re
import shutil
from html.parser import HTMLParser

import pytest
from synthetic import Lift, write_run

from shipcrane_twin.record.read import BagError
from shipcrane_twin.report.page import ReportError, write_report


class Elements(HTMLParser):
    """Collects start tags and checks that every element is closed."""

    VOID = frozenset({"meta", "link", "img"})

    def __init__(self, text):
        super().__init__()
        self.tags, self.open = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def reported(made_up, tmp_path_factory):
    """A run directory with its report, only read by the tests."""
    run = shutil.copytree(made_up[1], tmp_path_factory.mktemp("reported") / "run")
    assert write_report(run) == run / "report.html"
    return run


@pytest.fixture
def run(made_up, tmp_path):
    return shutil.copytree(made_up[1], tmp_path / "run")


def test_the_page_holds_every_figure_and_loads_nothing(reported):
    text = (reported / "report.html").read_text(encoding="utf-8")
    elements = Elements(text)
    assert elements.open == []
    images = [attrs["src"] for tag, attrs in elements.tags if tag == "img"]
    files = sorted((reported / "figures").glob("*.png"))
    assert len(files) == len(images) == 6
    inline = {base64.b64decode(src.removeprefix("data:image/png;base64,")) for src in images}
    assert inline == {file.read_bytes() for file in files}
    loading = ("src", "href", "srcset", "action")
    loads = [value for _, attrs in elements.tags for name, value in attrs.items() if name in loading]
    assert all(value.startswith("data:") for value in loads)
    assert not re.search(r"https?:|//[a-z]|url\(|@import|<script|<iframe", re.sub(r'src="[^"]*"', "", text))


def test_every_figure_has_one_sentence_that_says_what_to_see(reported):
    text = (reported / "report.html").read_text(encoding="utf-8")
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", text)
    assert len(captions) == 6
    assert all(len(caption) > 30 and caption.endswith(".") for caption in captions)


def test_run_and_results_are_in_the_tables(reported):
    text = (reported / "report.html").read_text(encoding="utf-8")
    for cell in ("made_up", "inline", "321.5 x", "20 ms", "40 s", "2.500", "&minus;0.500", "6.865", "0.500"):
        assert f"<td>{cell}</td>" in text
    assert "No message is missing" in text


def test_text_from_outside_is_escaped(run):
    scenario = run / "scenario.yaml"
    scenario.write_text(scenario.read_text() + "note: '</pre><script>alert(1)</script> {title}'\n")
    text = write_report(run).read_text(encoding="utf-8")
    assert "<script" not in text
    assert "&lt;/pre&gt;&lt;script&gt;alert(1)&lt;/script&gt; {title}" in text
    assert "<title>A made-up lift &lt;calm&gt;</title>" in text


def test_missing_messages_are_shown(tmp_path):
    run = write_run(tmp_path / "run", Lift(duration_s=4.0), {"/crane/tip": {3, 4}})
    text = write_report(run).read_text(encoding="utf-8")
    assert "The bag is not complete" in text
    assert "/crane/tip: 199 messages instead of 201, first missing at t = 0.06 s" in text


def test_without_summary_the_bag_alone_is_reported(run):
    (run / "summary.json").unlink()
    text = write_report(run).read_text(encoding="utf-8")
    assert "Real-time factor" not in text
    assert "<td>made_up</td>" in text


def test_the_same_run_gives_the_same_report(reported, run):
    assert write_report(run).read_bytes() == (reported / "report.html").read_bytes()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("scenario.yaml", None, "scenario.yaml: cannot be read"),
        ("scenario.yaml", "a: [", "scenario.yaml: cannot be read"),
        ("scenario.yaml", "- a", "expected a mapping, found list"),
        ("scenario.yaml", "title: only", "not a resolved scenario"),
        ("summary.json", "{", "summary.json: cannot be read.*bag alone"),
        ("summary.json", "[]", "expected an object, found list"),
    ],
)
def test_what_is_wrong_with_the_run_directory_is_said(run, name, content, message):
    file = run / name
    file.unlink() if content is None else file.write_text(content)
    with pytest.raises(ReportError, match=message):
        write_report(run)
    assert not (run / "report.html").exists()


def test_a_directory_without_a_bag_is_refused(tmp_path):
    with pytest.raises(BagError, match="no bag there"):
        write_report(tmp_path)
