"""Scenes written by Python instead of a file."""
from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import Any, Callable


def _number(value: Any) -> str:
    try:
        return repr(int(value) if isinstance(value, int) else float(value))
    except (TypeError, ValueError):
        raise TypeError(f"neither a word nor a number: {value!r}") from None


def _words(values: Iterable[Any]) -> Iterable[str]:
    for value in values:
        if isinstance(value, str):
            yield value
        elif isinstance(value, Iterable):
            yield from _words(value)
        else:
            yield _number(value)


class _Block:
    def __init__(self, description: Description) -> None:
        self._description = description

    def __enter__(self) -> Description:
        self._description._depth += 1
        return self._description

    def __exit__(self, *error: Any) -> None:
        self._description._depth -= 1
        self._description.add("end")


class Description:
    """The text of a scene, line by line: each word of a scene is a method, a block a `with`.

    >>> scene = Description()
    >>> scene.duration(10)
    >>> with scene.body("hub", "rigid"):
    ...     scene.hub(500, (0, 0, 0), (80, 80, 80))
    >>> Scene(scene)

    Arrays and lists are spread over the line; `row` writes the lines of a table; `add` takes the word as a text.
    """

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._depth = 0

    def add(self, word: str, *values: Any) -> _Block:
        self._lines.append("  " * self._depth + " ".join([word, *_words(values)]))
        return _Block(self)

    def row(self, *values: Any) -> None:
        self._lines.append("  " * self._depth + " ".join(_words(values)))

    def __getattr__(self, word: str) -> Callable[..., _Block]:
        if word.startswith("_"):
            raise AttributeError(word)
        return functools.partial(self.add, word)

    def __str__(self) -> str:
        return "\n".join(self._lines) + "\n"
