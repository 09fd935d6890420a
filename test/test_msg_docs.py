import importlib.util
import re
import time
from pathlib import Path

import pytest
from graph_runs import NODES, cli_run, needs_ros, operator_in, write_lively

from shipcrane_twin.cosim.controllers import CONTROLLER_INPUTS, CONTROLLER_TOPICS
from shipcrane_twin.cosim.coupling import INPUTS
from shipcrane_twin.cosim.topics import BY_NAME, JOINT_FIELDS, JOINTS, TOPICS

ALL_TOPICS = (*TOPICS, *CONTROLLER_TOPICS.values())
NAMES = {topic.name for topic in ALL_TOPICS}
DOCS = Path(__file__).resolve().parents[1] / "msg_docs"
PAGES = {path.name: path.read_text(encoding="utf-8") for path in sorted(DOCS.glob("*.md"))}
RATES = {"step": "every macro step", "telemetry": "every telemetry period", "once": "once", "irregular": "irregular"}
SERVICES = {"/clock/pause", "/clock/step", "/dp/enable"}
NOT_OURS = {"/parameter_events", "/rosout"}
RCLPYS = {"use_sim_time", "start_type_description_service"}


def rows(text):
    """Return the cells of all table rows of a text."""
    lines = [line for line in text.splitlines() if line.startswith("|") and not re.fullmatch(r"[|\-]+", line)]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def sections():
    """Return the text under every heading that names a topic."""
    found = {}
    for text in PAGES.values():
        for part in re.split(r"^## ", text, flags=re.M)[1:]:
            heading = re.match(r"`(/[\w/]+)`\n", part)
            if heading:
                assert heading[1] not in found, f"{heading[1]} is described twice"
                found[heading[1]] = part
    return found


SECTIONS = sections()


def facts(topic):
    return {row[0]: row[1].strip("`") for row in rows(SECTIONS[topic]) if len(row) == 2}


def listeners(topic):
    return set(facts(topic)["listeners"].split(", "))


def test_every_topic_is_described_and_no_other():
    assert SECTIONS.keys() == NAMES


@pytest.mark.parametrize("topic", ALL_TOPICS, ids=lambda topic: topic.name)
def test_facts_are_those_of_the_topic_table(topic):
    told = facts(topic.name)
    assert told["type"] == topic.type
    assert told["frame"] == (topic.frame or "none")
    assert told.get("child frame", "") == topic.child_frame
    assert told["publisher"] == ", ".join((topic.publisher, *topic.others))
    assert told["rate"].startswith(RATES[topic.rate])
    assert {name for name, topics in INPUTS.items() if topic.name in topics} <= listeners(topic.name)


def test_controllers_hear_and_command_what_is_told():
    told = {row[0].strip("`"): row[1:3] for row in rows(PAGES["controllers.md"]) if len(row) == 4}
    for kind, topic in CONTROLLER_TOPICS.items():
        heard, commands = told[kind]
        assert tuple(re.findall(r"`(/[\w/]+)`", heard)) == CONTROLLER_INPUTS[kind]
        assert tuple(commands.split(", ")) == topic.joints


@pytest.mark.parametrize("topic", [t for t in ALL_TOPICS if t.type == JOINTS], ids=lambda topic: topic.name)
def test_every_joint_and_filled_array_is_described(topic):
    table = {}
    for row in rows(SECTIONS[topic.name]):
        if len(row) == 4:
            table |= dict.fromkeys(re.findall(r"`(\w+)`", row[0]), row[1:])
    assert tuple(table) == topic.joints
    for cells in table.values():
        told = dict(zip(JOINT_FIELDS, cells, strict=True))
        assert tuple(field for field, cell in told.items() if cell not in ("-", "ignored")) == topic.fields


def test_no_page_names_a_topic_or_service_that_does_not_exist():
    roots = {name.split("/")[1] for name in NAMES}
    for page, text in PAGES.items():
        named = {name for name in re.findall(r"(?<![\w.)/])/[a-z_]+(?:/[a-z_]+)*", text) if name.split("/")[1] in roots}
        assert named <= NAMES | SERVICES, page


def test_every_page_is_in_the_index_and_every_link_leads_somewhere():
    linked = set(re.findall(r"\]\((\w+\.md)", PAGES["README.md"]))
    assert linked == PAGES.keys() - {"README.md"}
    for page, text in PAGES.items():
        assert set(re.findall(r"\]\((\w+\.md)", text)) <= PAGES.keys(), page


def test_every_wrench_tells_its_reference_point():
    told = {row[0].strip("`") for row in rows(PAGES["conventions.md"]) if len(row) == 4}
    assert {topic.name for topic in TOPICS if topic.type.endswith("WrenchStamped")} <= told


def test_depth_of_the_queues_is_the_one_told():
    pytest.importorskip("rclpy", reason="rclpy is not installed (extra: ros)")
    from shipcrane_twin.ros.links import LOOP_DEPTH

    for topic in TOPICS:
        if topic.rate == "once":
            assert facts(topic.name)["QoS"] == "reliable, transient local, keep last 1"
        elif topic.rate != "irregular":
            assert facts(topic.name)["QoS"] == f"reliable, volatile, keep last {LOOP_DEPTH}"


def documented_parameters(node):
    tables = re.split(r"^The clock alone has$|^They are read once", PAGES["clock.md"], flags=re.M)
    own = {"clock": [tables[-1]], "vessel": [PAGES["operator_commands.md"]]}
    return {
        row[0].strip("`"): row[1]
        for table in (tables[0], *own.get(node, ()))
        for row in rows(table.partition("## Parameters")[2] or table)
        if len(row) == 3 and row[0] != "parameter"
    }


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """Return an operator beside a running, recorded graph."""
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("rclpy is not installed (extra: ros)")
    folder = tmp_path_factory.mktemp("docs")
    scenario = write_lively(folder, duration_s=10000.0)
    with cli_run(folder / "run", scenario, "--speed", "1") as run, operator_in(run.domain) as operator:
        run.wait_for_time(0.5)
        operator.say(names=[], velocities=[])
        yield operator


def untold(graph):
    """Return what a running graph shows of each topic, where it is not what the pages tell."""
    wrong = {name: "not in the graph" for name in BY_NAME if name not in graph}
    for name, seen in graph.items():
        if name in NOT_OURS:
            continue
        publishers = sorted(node.replace("test_operator", "operator") for node, _, _ in seen["publishers"])
        shown = (seen["types"], ", ".join(publishers), set(seen["listeners"]))
        if name not in BY_NAME or shown != ([facts(name)["type"]], facts(name)["publisher"], listeners(name)):
            wrong[name] = shown
    return wrong


class TestRunningGraph:
    pytestmark = needs_ros

    def test_types_publishers_and_listeners_are_as_told(self, running):
        # Discovery has no end: an announcement that got lost is repeated some seconds later.
        deadline = time.monotonic() + 20.0
        while (wrong := untold(running.topics())) and time.monotonic() < deadline:
            time.sleep(0.5)
        assert not wrong

    def test_quality_of_service_is_as_told(self, running):
        for name, seen in running.topics().items():
            if name not in NOT_OURS:
                durability = "TRANSIENT_LOCAL" if BY_NAME[name].rate == "once" else "VOLATILE"
                assert {tuple(end[1:]) for end in seen["publishers"]} == {("RELIABLE", durability)}
                assert f"reliable, {durability.lower().replace('_', ' ')}" in facts(name)["QoS"]

    def test_services_are_as_told(self, running):
        own = {name: types for name, types in running.services().items() if name in SERVICES or "std_srvs" in types[0]}
        told = {
            row[0].strip("`"): [row[1].strip("`")]
            for text in PAGES.values()
            for row in rows(text)
            if row[0].startswith("`/") and "/srv/" in row[1]
        }
        assert own == told

    @pytest.mark.parametrize("node", NODES)
    def test_parameters_are_as_told(self, node, running):
        declared = {name: about for name, about in running.parameters(node=node).items() if name not in RCLPYS}
        assert declared.keys() == documented_parameters(node).keys()
        for name, (description, read_only) in declared.items():
            assert description
            assert read_only == (name not in ("speed", "power_share") and not name.startswith("fault."))
