"""Find, read, merge and write scenario files."""

import difflib
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from shipcrane_twin.config.places import config_dir
from shipcrane_twin.config.scenario import Scenario, problems
from shipcrane_twin.config.settings import ConfigError, dotted, plain, read_settings, shown


class _Loader(yaml.SafeLoader):
    """Safe YAML that refuses keys that are no text or given twice."""


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    keys = [loader.construct_object(key) for key, _ in node.value if key.tag != "tag:yaml.org,2002:merge"]
    for key in keys:
        if not isinstance(key, str):
            raise yaml.constructor.ConstructorError(None, None, f"the key {key!r} is not text", node.start_mark)
        if keys.count(key) > 1:
            raise yaml.constructor.ConstructorError(
                None, None, f"the key {key!r} is given twice; keep one", node.start_mark
            )
    loader.flatten_mapping(node)  # what `<<: *anchor` brings
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)


def list_scenarios() -> dict[str, Path]:
    """Return the scenarios that come with the package: name and file."""
    return {path.stem: path for path in sorted((config_dir() / "scenarios").glob("*.yaml"))}


def find_scenario(name: str) -> Path:
    """Return the file of a scenario given by name or path.

    Raises
    ------
    ConfigError
        If there is neither; names the nearest scenario.
    """
    path = Path(name).expanduser()
    if path.suffix in (".yaml", ".yml"):
        if path.is_file():
            return path
        raise ConfigError(f"{path}: no such scenario file; give a path to a YAML file or one of {known_names()}")
    scenarios = list_scenarios()
    if name in scenarios:
        return scenarios[name]
    close = difflib.get_close_matches(name, scenarios, n=1)
    advice = f"did you mean {close[0]}?" if close else f"there are {known_names()}"
    raise ConfigError(f"scenario {name!r} is unknown; {advice} A path must end in .yaml")


def known_names() -> str:
    """Return the names of the package's scenarios for a message."""
    return ", ".join(list_scenarios()) + "."


def read_yaml(path: Path) -> dict[str, Any]:
    """Return a YAML file's mapping, with the files it names found; ConfigError with the line if it cannot be read."""
    try:
        data = yaml.load(path.read_text(encoding="utf-8"), _Loader)
    except yaml.YAMLError as err:
        raise ConfigError(f"{path}: not valid YAML: {' '.join(str(err).split())}") from None
    except (OSError, UnicodeDecodeError) as err:
        raise ConfigError(f"{path}: cannot be read: {err}") from None
    if not isinstance(data, dict):
        raise ConfigError(f"{path}: expected a mapping of keys to values, found {type(data).__name__}")
    return find_files(data, path.parent)


def find_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the mapping with every ``..._file`` that lies in a folder made absolute; others stay as they are."""
    out: dict[str, Any] = {}
    for key, value in data.items():
        if isinstance(value, dict):
            value = find_files(value, folder)
        elif isinstance(value, list):
            value = [find_files(item, folder) if isinstance(item, dict) else item for item in value]
        elif key.endswith("_file") and isinstance(value, str) and (folder / value).is_file():
            value = str((folder / value).resolve())
        out[key] = value
    return out


def merge(base: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    """Return two nested mappings as one; ``top`` wins, lists are replaced whole."""
    out = dict(base)
    for key, value in top.items():
        old = out.get(key)
        out[key] = merge(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return out


def resolve_uses(data: dict[str, Any], path: Path, users: tuple[Path, ...] = ()) -> dict[str, Any]:
    """Return the mapping with every ``use: FILE`` replaced by that file's content under the given keys.

    Parameters
    ----------
    data : dict
        What the file ``path`` holds, or a part of it.
    path : Path
    users : tuple of Path
        The files that led to this one.
    """
    out = {key: resolve_uses(value, path, users) if isinstance(value, dict) else value for key, value in data.items()}
    if "use" not in out:
        return out
    name = out.pop("use")
    for folder in (path.parent, config_dir()):
        used = folder / str(name)
        if used.is_file():
            if used.resolve() in (*users, path.resolve()):
                raise ConfigError(f"{path}: use is {name!r}, which uses this file in turn; break the circle")
            return merge(resolve_uses(read_yaml(used), used, (*users, path.resolve())), out)
    raise ConfigError(f"{path}: use is {name!r}, expected a YAML file beside it or under {config_dir()}")


def data_file(name: str) -> Path:
    """Return the file that a key ending in ``_file`` names once a scenario is read: absolute, or in the package."""
    return config_dir() / name


def parse_override(text: str) -> tuple[list[str], Any]:
    """Return key path and value of one ``key=value``; ConfigError if it has no equals sign."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise ConfigError(f"--set {text!r}: expected key=value, for instance macro_step_ms=50")
    try:
        path = key.strip().split(".")
        return path, find_files({path[-1]: yaml.load(value, _Loader)}, Path())[path[-1]]
    except yaml.YAMLError:
        raise ConfigError(f"--set {text!r}: the value is not valid YAML") from None


def apply_override(data: dict[str, Any], path: Sequence[str], value: Any) -> dict[str, Any]:
    """Return the mapping with one dotted key set; a number in the path is an index into a list."""
    data = merge({}, data)
    place: Any = data
    for i, part in enumerate(path[:-1]):
        key: Any = int(part) if isinstance(place, list) and part.isdigit() else part
        try:
            child = place[key]
        except (KeyError, IndexError, TypeError):
            child = None
        if not isinstance(child, dict | list):
            raise ConfigError(f"--set {dotted(path)}: there is no group {dotted(path[: i + 1])} to set a key in")
        place[key] = place = child.copy()
    last: Any = int(path[-1]) if isinstance(place, list) and path[-1].isdigit() else path[-1]
    try:
        place[last] = value
    except (IndexError, TypeError):
        raise ConfigError(f"--set {dotted(path)}: index {last!r} is outside the list") from None
    return data


def load_scenario(name: str, overrides: Sequence[str] = ()) -> Scenario:
    """Read a scenario by name or path, with its parts and overrides, and check all of it.

    Parameters
    ----------
    name : str
        A scenario of the package or a path to a YAML file.
    overrides : sequence of str
        ``dotted.key=value`` texts, applied in order.

    Raises
    ------
    ConfigError
        One message with file, key, value, expectation and the nearest correct key.
    """
    path = find_scenario(name)
    own = read_yaml(path)
    data = merge({"name": path.stem}, resolve_uses(own, path))
    changed = [parse_override(text) for text in overrides]
    for key, value in changed:
        data = apply_override(data, key, value)

    where = partial(origin, path=path, own=own, changed=[key for key, _ in changed])
    scenario = read_settings(Scenario, data, where)
    for key_path, advice in problems(scenario):
        raise ConfigError(f"{where(key_path)}: {dotted(key_path)} is {shown(look_up(data, key_path))}, {advice}")
    return scenario


def origin(key: Sequence[Any], path: Path, own: dict[str, Any], changed: list[list[str]]) -> str:
    """Return where a key's value came from: ``--set``, the scenario, or the file the scenario uses."""
    parts = [str(part) for part in key]
    if any(parts[: len(one)] == one or one[: len(parts)] == parts for one in changed):
        return "--set"
    place: Any = own
    used = None
    for part in key:
        if isinstance(place, dict) and "use" in place:
            used = place["use"]
        if isinstance(place, dict) and part in place:
            place = place[part]
        elif isinstance(place, list) and isinstance(part, int) and part < len(place):
            place = place[part]
        else:
            return f"{path} (through {used})" if used else str(path)
    return str(path)


def look_up(data: Any, key: Sequence[Any]) -> Any:
    """Return the value at a key path of plain data; None for a key that is left out."""
    for part in key:
        data = data.get(part) if isinstance(data, dict) else data[part]
    return data


def scenario_yaml(scenario: Scenario) -> str:
    """Return the resolved scenario as YAML text that `load_scenario` reads back to the same scenario."""
    return yaml.safe_dump(plain(scenario), sort_keys=False, allow_unicode=True)
