"""Former names of the methods of an effect, which effects of users may still have."""

import warnings
from typing import TYPE_CHECKING

RENAMED = {
    "caution": "penalty",
    "telling": "is_recognised",
    "richer": "combined",
    "poorer": "reduced",
    "settled": "consistent",
}
"""Methods of an effect by their former names."""


class FormerNames:
    """Base that finds and takes methods by their former names, with a warning."""

    def __init_subclass__(cls, **options: object) -> None:
        """Let effects of users that override methods by their former names go on working."""
        super().__init_subclass__(**options)
        for old, new in RENAMED.items():
            if old in vars(cls):
                warnings.warn(
                    f"{cls.__name__}.{old} is now {new}", DeprecationWarning, stacklevel=2
                )
                setattr(cls, new, vars(cls)[old])

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            """Find methods by their former names."""
            if name not in RENAMED:
                raise AttributeError(name)
            new = RENAMED[name]
            warnings.warn(f"Effect.{name} is now {new}", DeprecationWarning, stacklevel=2)
            return getattr(self, new)
