"""The exceptions of vitral."""

from __future__ import annotations


class Error(Exception):
    """Why something could not be done; the base of all exceptions of vitral.

    The text is that of the command line. ``hint`` is what may help, or ``None``.
    """

    def __init__(
        self,
        message: str,
        hint: str | None = None,
        path: str | None = None,
        where: str | None = None,
    ) -> None:
        super().__init__(message, hint, path, where)
        self.message = message
        self.hint = hint
        self.path = path
        self.where = where

    def __str__(self) -> str:
        return self.message if self.hint is None else f"{self.message}\nhint: {self.hint}"


class UsageError(Error, ValueError):
    """Something was asked for that is not there: an option, a name, a value out of range."""


class InputError(Error, ValueError):
    """A file is missing or malformed: ``path`` names it, ``where`` the line or part in it."""


class UnsupportedError(Error):
    """Known, but not possible here: a format, or a feature of one."""


class LimitError(Error):
    """A limit was reached; also a ``TimeoutError`` or ``MemoryError`` where it is one."""


class _TimeLimitError(LimitError, TimeoutError):
    """The time limit."""


class _MemoryLimitError(LimitError, MemoryError):
    """The memory limit."""


for _class in (Error, UsageError, InputError, UnsupportedError, LimitError):
    _class.__module__ = "vitral"
