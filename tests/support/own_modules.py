"""What this process has registered of users' own, put back after a test."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from cyclosweep import plugins
from cyclosweep.simulation import effects


@contextmanager
def registered_for_now() -> Iterator[None]:
    """Forget afterwards the effects, columns, constraints and modules of the time between."""
    tables = (effects._REGISTERED, plugins.COLUMNS, plugins.CONSTRAINTS)
    before = [dict(table) for table in tables]
    loaded, path, modules = list(plugins.LOADED), list(sys.path), set(sys.modules)
    try:
        yield
    finally:
        for table, content in zip(tables, before, strict=True):
            table.clear()  # type: ignore[attr-defined]
            table.update(content)  # type: ignore[attr-defined]
        plugins.LOADED[:], sys.path[:] = loaded, path
        # A module that is imported again registers again.
        own = [name for name in set(sys.modules) - modules if name == "washers"]
        for name in own:
            del sys.modules[name]
