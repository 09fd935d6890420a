"""Write rosbag2 directories: MCAP in chunks, serialized messages as they come, simulated time as log time."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from mcap.writer import CompressionType, Writer
from rosbags.typesys import Stores, get_typestore

from shipcrane_twin import __version__
from shipcrane_twin.config.load import scenario_yaml
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim.controllers import topics_of
from shipcrane_twin.cosim.topics import TOPICS, Topic

LIBRARY = "shipcrane_twin"
COMPRESSION = {"zstd": CompressionType.ZSTD, "none": CompressionType.NONE}
QOS = """- history: keep_last
  depth: 10
  reliability: reliable
  durability: {durability}
  deadline: {{sec: 9223372036, nsec: 854775807}}
  lifespan: {{sec: 9223372036, nsec: 854775807}}
  liveliness: automatic
  liveliness_lease_duration: {{sec: 9223372036, nsec: 854775807}}
  avoid_ros_namespace_conventions: false
"""
"""Of a topic, in the file and in metadata.yaml: readers match the two."""


def offered_qos(topic: Topic) -> str:
    """Return the quality of service with which a player should publish a topic, as rosbag2 writes it."""
    return QOS.format(durability="transient_local" if topic.rate == "once" else "volatile")


NOT_RECORDED = "/recorder/progress"
"""Is not part of a run."""

RECORDED = tuple(topic for topic in TOPICS if topic.name != NOT_RECORDED)
"""What every bag of the twin holds."""


def recorded_topics(scenario: Scenario) -> tuple[Topic, ...]:
    """Return what a bag of a run of this scenario holds: its controllers' topics as well."""
    return tuple(topic for topic in topics_of(scenario) if topic.name != NOT_RECORDED)


def bag_options(scenario: Scenario) -> dict[str, Any]:
    """Return the arguments of `BagWriter`, beside the folder, for the bag of a run of this scenario."""
    return {
        "topics": recorded_topics(scenario),
        "compression": scenario.recording.compression,
        "chunk_kib": scenario.recording.chunk_kib,
        "metadata": {"scenario": scenario_yaml(scenario), "version": __version__, "seed": str(scenario.seed)},
    }


class BagWriter:
    """A rosbag2 directory being written; `close` makes it complete.

    Parameters
    ----------
    folder : Path
        Is made anew; one that exists is an error.
    topics : sequence of Topic
        The topics to come.
    compression : str
        ``zstd`` or ``none``.
    chunk_kib : int
        Size of an uncompressed chunk [KiB].
    metadata : mapping of str to str
        Kept in the file and in metadata.yaml: scenario, version, seed.

    Raises
    ------
    FileExistsError
        If the folder exists.
    """

    def __init__(
        self,
        folder: Path,
        topics: tuple[Topic, ...],
        *,
        compression: str,
        chunk_kib: int,
        metadata: Mapping[str, str],
    ) -> None:
        folder.mkdir(parents=True, exist_ok=False)
        self._folder = folder
        self._topics = topics
        self._custom = dict(metadata)
        self.counts = dict.fromkeys((topic.name for topic in topics), 0)
        self._first_ns: int | None = None
        self._last_ns = 0
        self._path = folder / f"{folder.name}_0.mcap"
        self._stream = self._path.open("wb")
        self._writer = Writer(
            self._stream, chunk_size=chunk_kib * 1024, compression=COMPRESSION[compression], enable_crcs=True
        )
        self._writer.start(profile="ros2", library=LIBRARY)
        self._hashes: dict[str, str] = {}
        self._channels = self._register()
        self._writer.add_metadata("shipcrane_twin", self._custom)

    def _register(self) -> dict[str, int]:
        store = get_typestore(Stores.ROS2_JAZZY)
        schemas: dict[str, int] = {}
        channels = {}
        for topic in self._topics:
            if topic.type not in schemas:
                definition, _ = store.generate_msgdef(topic.type, ros_version=2)
                schemas[topic.type] = self._writer.register_schema(topic.type, "ros2msg", definition.encode())
                self._hashes[topic.type] = store.hash_rihs01(topic.type)
            channels[topic.name] = self._writer.register_channel(
                topic.name,
                "cdr",
                schemas[topic.type],
                {"offered_qos_profiles": offered_qos(topic), "topic_type_hash": self._hashes[topic.type]},
            )
        return channels

    def write(self, topic: str, time_ns: int, message: bytes) -> None:
        """Append one serialized message with its simulated time [ns] as log and publish time."""
        self._writer.add_message(self._channels[topic], time_ns, message, time_ns, self.counts[topic])
        self.counts[topic] += 1
        if self._first_ns is None:
            self._first_ns = time_ns
        self._first_ns = min(self._first_ns, time_ns)
        self._last_ns = max(self._last_ns, time_ns)

    def close(self) -> None:
        """Finish the file and write metadata.yaml."""
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()
        text = yaml.safe_dump({"rosbag2_bagfile_information": self._information()}, sort_keys=False)
        part = self._folder / ".metadata.part"
        part.write_text(text, encoding="utf-8")
        part.replace(self._folder / "metadata.yaml")

    def _information(self) -> dict[str, Any]:
        first = self._first_ns or 0
        start = {"nanoseconds_since_epoch": first}
        duration = {"nanoseconds": self._last_ns - first}
        total = sum(self.counts.values())
        file = {"path": self._path.name, "starting_time": start, "duration": duration, "message_count": total}
        return {
            "version": 9,
            "storage_identifier": "mcap",
            "duration": dict(duration),
            "starting_time": dict(start),
            "message_count": total,
            "topics_with_message_count": [
                {
                    "topic_metadata": {
                        "name": topic.name,
                        "type": topic.type,
                        "serialization_format": "cdr",
                        "offered_qos_profiles": yaml.safe_load(offered_qos(topic)),
                        "type_description_hash": self._hashes[topic.type],
                    },
                    "message_count": self.counts[topic.name],
                }
                for topic in self._topics
            ],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [self._path.name],
            "files": [file],
            "custom_data": self._custom,
            "ros_distro": "jazzy",
        }


