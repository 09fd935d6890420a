"""Where the package's own files lie: in a checkout, in a pip prefix, in a colcon install."""

import sys
from pathlib import Path

PACKAGE = "shipcrane_twin"


def share_dir() -> Path:
    """Return the folder that holds ``config/``, ``launch/`` and ``msg_docs/``.

    Raises
    ------
    FileNotFoundError
        If the package was installed without its data files.
    """
    here = Path(__file__).resolve()
    candidates = [here.parents[2]]  # a checkout: beside the package
    # <prefix>/lib/pythonX.Y/site-packages/shipcrane_twin/config/places.py
    candidates += [parent / "share" / PACKAGE for parent in here.parents[3:7]]
    candidates.append(Path(sys.prefix) / "share" / PACKAGE)
    for folder in candidates:
        if (folder / "config" / "scenarios").is_dir():
            return folder
    raise FileNotFoundError(
        f"the files of {PACKAGE} (config/scenarios) were not found beside {here.parents[1]}; install the package again"
    )


def config_dir() -> Path:
    """Return the folder with scenarios, vessels and cranes."""
    return share_dir() / "config"
