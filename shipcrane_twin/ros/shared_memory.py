"""Files that Fast DDS keeps in /dev/shm: found by what a process maps, removed when their owner is gone.

Fast DDS removes them when a participant is deleted, which the nodes do not do (see `ros.process`), and
leaves them behind when a process is killed. Leftovers slow every later run.

As a program (``python shared_memory.py NAME ...``) it removes what is left of some of them a moment later.
"""

import fcntl
import re
import subprocess
import sys
import time
from pathlib import Path

SHM = Path("/dev/shm")
NAME = re.compile(r"/dev/shm/(fastrtps_\w+)")
LOCK = "_el"
"""A segment or port NAME is alive while somebody holds the lock on NAME_el."""
AFTERMATH_S = 0.4


def mapped_names(pid: int | str = "self") -> set[str]:
    """Return the segments and ports that a process maps; empty if it is gone or there is no /proc."""
    try:
        return set(NAME.findall(Path(f"/proc/{pid}/maps").read_text(encoding="utf-8")))
    except OSError:
        return set()


def remove_own() -> None:
    """Remove what this process owns: the last thing before it ends.

    Its peers, while they still live, make the files of its port anew when they send to it. So a small
    process looks again when they have ended too.
    """
    names = mapped_names()
    for descriptor in Path("/proc/self/fd").glob("*"):
        try:
            target = descriptor.readlink()
        except OSError:
            continue  # closed since it was listed
        if target.parent == SHM and target.name.endswith(LOCK):
            remove(target.name.removesuffix(LOCK))
    if names:
        # -I -S: nothing but the standard library, so that it starts in no time
        subprocess.Popen([sys.executable, "-I", "-S", __file__, *sorted(names)], start_new_session=True)


def remove_orphans(names: set[str]) -> None:
    """Remove those of the named segments and ports whose owner no longer lives."""
    for name in names:
        if not is_locked(SHM / (name + LOCK)):
            remove(name)


def is_locked(path: Path) -> bool:
    """Whether somebody holds the lock on a file; not if there is no such file."""
    try:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


def remove(name: str) -> None:
    """Remove the files of one segment or port."""
    for file in (name, name + LOCK, f"sem.{name}_mutex"):
        (SHM / file).unlink(missing_ok=True)


if __name__ == "__main__":
    time.sleep(AFTERMATH_S)
    remove_orphans(set(sys.argv[1:]))
