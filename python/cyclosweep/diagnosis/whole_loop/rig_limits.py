"""What the rig of a recording cannot show, where whole loops are fitted."""

import numpy as np

from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.recording import Recording
from cyclosweep.result import Untestable

AT_LIMIT = 0.06
"""Share of samples near the largest torque from which the actuator is taken to be at its limit."""
NEAR_LARGEST = 0.93
"""Share of the largest torque from which a sample counts as near it."""
BELOW_LARGEST = 0.8
"""Share of the largest torque from which samples are compared with those near it."""

MOTOR_CURRENT = Untestable(
    name="independent_torque",
    reason="torque is computed from the motor current: drag and friction of the motor and its "
    "torque constant are part of every torque read here",
    needs="a torque sensor at the output",
)
RIPPLE = (
    "the torque is computed from the motor current: its ripple and cogging repeat with the turn of "
    "the motor. Where the recording spans a few periods only, they cannot be told from a curve of "
    "the torque, or a transmission error, of the same size: compare with a torque sensor, or with "
    "another part of the motor's turn"
)
"""Remark on a torque from a current, where something was found."""
ONE_POSITION = Untestable(
    name="other_mesh_positions",
    reason="the output was locked at one position of the mesh; stiffness, play and staircase "
    "of other positions differ",
    needs="the same ramps at several locking positions",
)
NO_TEMPERATURE = Untestable(
    name="temperature",
    reason="no temperature was recorded, so warming up cannot be told from wear or creep",
    needs="a temperature column",
)


def rig_limits(problem: Problem) -> list[Untestable]:
    """Return what the rig cannot show, beside what every calibration hides."""
    recording = problem.recording
    found = []
    if recording.torque_from == "motor-current":
        found.append(MOTOR_CURRENT)
    if recording.crank_deg is None or np.ptp(recording.crank_deg) == 0:
        found.append(ONE_POSITION)
    if recording.temperature_c is None:
        found.append(NO_TEMPERATURE)
    limit = _actuator_limit(recording)
    return found if limit is None else [*found, limit]


def _actuator_limit(recording: Recording) -> Untestable | None:
    """The largest torque as a limit of the actuator, where the torque dwells at it."""
    torque = np.abs(recording.torque_nm)
    if not len(torque):
        return None
    largest = float(torque.max())
    near = torque > NEAR_LARGEST * largest
    held = float(np.mean(near))
    below = float(np.mean((torque > BELOW_LARGEST * largest) & ~near))
    if held <= AT_LIMIT or held <= 1.5 * below:
        return None
    return Untestable(
        name="loads_beyond_the_limit",
        reason=f"torque stands near {largest:.3g} N m for {100 * held:.0f} % of the samples: the "
        "actuator was at its limit, and nothing beyond was applied",
        needs="a stronger actuator",
    )
