"""A progress bar on standard error: share done, rate, time left."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self

__all__ = ["Progress"]

_SHOW_AFTER_S = 2.0


class Progress:
    """Progress of work counted in variants; silent where standard error is no terminal.

    Parameters
    ----------
    label : str
        What is being done.
    total : int
        How much there is.
    done : int
        How much of it an earlier run has done.
    show : bool, optional
        Whether to show it; by default after two seconds when standard error is a terminal.
    """

    def __init__(self, label: str, total: int, *, done: int = 0, show: bool | None = None) -> None:
        self._label, self._total, self._done, self._show = label, total, done, show
        self._earlier = done
        self._began = time.monotonic()
        self._bar: object | None = None

    def __enter__(self) -> Self:
        if self._show is None:
            self._show = sys.stderr.isatty()
        return self

    def advance(self, amount: int) -> None:
        """Count ``amount`` more as done."""
        self._done += amount
        if not self._show:
            return
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            TextColumn,
            TimeRemainingColumn,
        )
        from rich.progress import Progress as RichProgress

        if self._bar is None:
            if time.monotonic() - self._began < _SHOW_AFTER_S:
                return
            self._bar = RichProgress(
                TextColumn("{task.description}"),
                BarColumn(bar_width=None),
                MofNCompleteColumn(),
                TextColumn("{task.fields[rate]}"),
                TimeRemainingColumn(compact=True),
                console=Console(stderr=True),
                transient=True,
            )
            self._task = self._bar.add_task(
                self._label, total=self._total, completed=self._earlier, rate=""
            )
            self._bar.start()
        assert isinstance(self._bar, RichProgress)
        rate = (self._done - self._earlier) / max(time.monotonic() - self._began, 1e-9)
        self._bar.update(self._task, completed=self._done, rate=f"{rate / 1e6:.2f} M/s")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()  # type: ignore[attr-defined]
