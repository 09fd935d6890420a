"""Where compiled kernels are kept: one folder per state of their sources.

numba looks only at the file of a kernel itself. A kernel that has another file's kernel compiled into it
would live on after a change there, and give other bits than a fresh machine. So the folder's name holds a
digest of all sources.
"""

import contextlib
import hashlib
import os
import shutil
import tempfile
from pathlib import Path

PREFIX = "kernels-"


def use_kernel_cache() -> None:
    """Point numba to the folder; what the user set in NUMBA_CACHE_DIR stays. Must come before numba is imported."""
    if "NUMBA_CACHE_DIR" in os.environ:
        return
    package = Path(__file__).parent
    name = PREFIX + source_digest(package)
    homes = [
        package / "__pycache__",
        Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()) / "shipcrane_twin",
        Path(tempfile.gettempdir()) / f"shipcrane_twin-{os.getuid()}",
    ]
    for home in homes:
        with contextlib.suppress(OSError):
            folder = home / name
            if not folder.is_dir():
                folder.mkdir(parents=True)
                for old in home.glob(f"{PREFIX}*"):
                    if old != folder:
                        shutil.rmtree(old, ignore_errors=True)
            if os.access(folder, os.W_OK):
                os.environ["NUMBA_CACHE_DIR"] = str(folder)
                return


def source_digest(package: Path) -> str:
    """Return a short digest over the names and contents of all modules with kernels."""
    digest = hashlib.sha256()
    for folder in ("control", "physics"):
        for path in sorted((package / folder).glob("*.py")):
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
