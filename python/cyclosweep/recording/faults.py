"""What can be wrong with a recording that could be read.

The rule that divides bad input from a bad recording:

* What cannot be read as what it claims to be raises `InputError` (exit status 2): a missing,
  empty or truncated file, text where a number belongs, a missing column, an unknown key.
* What reads but cannot carry a diagnosis is a `Fault` with a verdict: `DATA_FAULT` where the
  numbers contradict each other or the physics (time that runs backwards, a third of the values
  missing), `INSUFFICIENT_DATA` where they are sound but too few or too uniform (two samples,
  constant torque).
* What reads and can be diagnosed, but a reader of the result should know, is a `Fault` without a
  verdict (a gap in the clock, a plateau at the end of the range).
"""

from dataclasses import dataclass
from typing import Literal

FaultVerdict = Literal["DATA_FAULT", "INSUFFICIENT_DATA"]


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong with a recording.

    Attributes
    ----------
    kind : str
        Short name, for example ``"time_backwards"``.
    verdict : {"DATA_FAULT", "INSUFFICIENT_DATA"} or None
        The verdict it forces; None where the recording can still be diagnosed.
    reason : str
        One sentence for an engineer: what, where, how much.
    """

    kind: str
    verdict: FaultVerdict | None
    reason: str
