"""What all settings share: the decorator, the number types, the error and how it is worded."""

import dataclasses
import difflib
import re
import types
import typing
from collections.abc import Sequence
from typing import Annotated, Any, TypeVar, dataclass_transform

from pydantic import ConfigDict, Strict, TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

T = TypeVar("T")

UNIT = re.compile(
    r"_(s|ms|ns|hz|m|mm|m2|m3|m_s|m_s2|kg|t|kg_m2|kg_m3|n|kn|n_m|deg|rad|rad_s|rad_s2|deg_s|deg_s2|pa|gpa|kw|rpm|rpm_s)$"
)


UNKNOWN = "unexpected_keyword_argument"
"""What pydantic calls an unknown key of a dataclass."""


class ConfigError(ValueError):
    """A settings file is wrong; the message names file, key, value and remedy."""


@dataclass_transform(kw_only_default=True, frozen_default=True)
def settings(cls: type[T]) -> type[T]:
    """Make a class a frozen settings dataclass in which unknown keys, NaN and infinities are errors."""
    cls.__pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)  # type: ignore[attr-defined]
    return dataclasses.dataclass(frozen=True, slots=True, kw_only=True)(cls)


Number = Annotated[float, Strict()]
Whole = Annotated[int, Strict()]
Flag = Annotated[bool, Strict()]
Text = Annotated[str, Strict()]
Vector3 = tuple[Number, Number, Number]
Row6 = tuple[Number, Number, Number, Number, Number, Number]
Matrix6 = tuple[Row6, Row6, Row6, Row6, Row6, Row6]


def read_settings(cls: type[T], data: dict[str, Any], where: typing.Callable[[Sequence[Any]], str]) -> T:
    """Turn plain data into a settings dataclass.

    Parameters
    ----------
    cls : type
        A class made by `settings`.
    data : dict
        Plain data as YAML gives it.
    where : callable
        Gives the origin (a file name, ``--set``) of a key path, for messages.

    Raises
    ------
    ConfigError
        Naming the first wrong key, its value, what was expected and the nearest correct key.
    """
    try:
        return TypeAdapter(cls).validate_python(data)
    except ValidationError as err:
        # an unknown key is usually the cause of a missing one, so it is told first
        details = sorted(err.errors(), key=lambda e: e["type"] != UNKNOWN)
        raise ConfigError(describe(cls, details[0], where)) from None


def describe(cls: type, detail: ErrorDetails, where: typing.Callable[[Sequence[Any]], str]) -> str:
    """Word one validation error: place, value, expectation, remedy."""
    path = without_tags(cls, detail["loc"])
    key = dotted(path)
    place = where(path)
    kind, value = detail["type"], detail["input"]
    if kind == UNKNOWN:
        return f"{place}: {key} is unknown; {nearest(str(path[-1]), known_keys(cls, path[:-1]))}"
    if kind in ("missing", "missing_argument", "missing_keyword_only_argument"):
        return f"{place}: {key} is missing; add it"
    message = detail["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    hint = ""
    if kind == "union_tag_not_found":
        return f"{place}: {key}.kind is missing; add it"
    if kind == "union_tag_invalid":
        key, value, message = f"{key}.kind", detail["ctx"]["tag"], f"one of {detail['ctx']['expected_tags']}"
    if kind == "dataclass_type":
        message = "a group with the keys " + ", ".join(known_keys(cls, path))
    if isinstance(value, str) and re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+", value.strip()):
        hint = "; YAML reads this as text, write it with a point and a signed exponent, like 5.0e+5"
    return f"{place}: {key} is {shown(value)}, expected {message}{hint}"


def without_tags(cls: Any, loc: Sequence[Any]) -> list[Any]:
    """Return pydantic's place of an error as a key path: without the kinds of the groups that it went through."""
    path: list[Any] = []
    for part in loc:
        options = dataclasses_in(cls)
        owner = next((option for option in options if part in option.__dataclass_fields__), None)
        if owner is not None:
            cls = typing.get_type_hints(owner)[part]
        elif tagged := [option for option in options if len(options) > 1 and part in kinds_of(option)]:
            cls = tagged[0]
            continue
        if part != "constrained-str":
            path.append(part)
    return path


def kinds_of(cls: Any) -> tuple[Any, ...]:
    """Return the values of the key ``kind`` that stand for a settings class."""
    return typing.get_args(typing.get_type_hints(cls).get("kind"))


def shown(value: Any) -> str:
    """Return a value for a message, cut to one readable line."""
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def dotted(path: Sequence[Any]) -> str:
    """Return a key path as the user writes it: ``operations[2].from_s``."""
    out = ""
    for part in path:
        out += f"[{part}]" if isinstance(part, int) else (f".{part}" if out else str(part))
    return out


def nearest(key: str, known: Sequence[str]) -> str:
    """Return advice for an unknown key: the same quantity in another unit, or the closest name."""
    stem = UNIT.sub("", key)
    for name in known:
        if UNIT.sub("", name) == stem and name != key:
            return f"unit clash: this setting is {name} (the unit is part of the key); convert the value"
    close = difflib.get_close_matches(key, known, n=1)
    if close:
        return f"did you mean {close[0]}?"
    return "known here: " + ", ".join(sorted(known))


def known_keys(cls: Any, path: Sequence[Any]) -> list[str]:
    """Return the keys that a settings class has at a path inside it."""
    for part in path:
        for option in dataclasses_in(cls):
            if part in option.__dataclass_fields__:
                cls = typing.get_type_hints(option)[part]
                break
    options = dataclasses_in(cls)
    return [name for option in options for name in option.__dataclass_fields__]


def dataclasses_in(hint: Any) -> list[Any]:
    """Return the settings classes that a type hint (plain, tuple of, optional) contains."""
    if dataclasses.is_dataclass(hint):
        return [hint]
    if typing.get_origin(hint) in (typing.Union, types.UnionType, tuple, list):
        return [found for arg in typing.get_args(hint) for found in dataclasses_in(arg)]
    return []


def plain(value: Any) -> Any:
    """Return settings as plain dicts, lists and numbers, ready for YAML."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            field.name: plain(getattr(value, field.name))
            for field in dataclasses.fields(value)
            if getattr(value, field.name) is not None
        }
    if isinstance(value, tuple | list):
        return [plain(item) for item in value]
    return value
