"""Name the files that go beside the Python code; everything else about the package stands in setup.cfg."""

from pathlib import Path

from setuptools import Distribution, setup

PACKAGE = "shipcrane_twin"
SHARE = f"share/{PACKAGE}"


def below(folder):
    """Return data_files entries that keep the layout of a folder under share/."""
    files = {}
    for path in sorted(Path(folder).rglob("*")):
        hidden = any(part.startswith((".", "__")) for part in path.parts)
        if path.is_file() and not hidden:
            files.setdefault(f"{SHARE}/{path.parent.as_posix()}", []).append(path.as_posix())
    return list(files.items())


class PackageWithFiles(Distribution):
    """A package whose files ``pip install -e`` installs as well: setuptools asks for has_data there."""

    has_data = Distribution.has_data_files


setup(
    distclass=PackageWithFiles,
    python_requires=">=3.11,<3.13",  # colcon cannot read it from setup.cfg
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (SHARE, ["package.xml"]),
        # ros2 run and ros2 launch look here; pip would put the scripts of entry points into bin/.
        (f"lib/{PACKAGE}", sorted(path.as_posix() for path in Path("executables").glob("[a-z]*"))),
        *below("config"),
        *below("launch"),
        *below("msg_docs"),
    ],
)
