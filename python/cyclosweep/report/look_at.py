"""What to look at on the drive when an effect, or a shape without a name, was found."""

LOOK_AT = {
    "friction_hysteresis": "bearings, seals and bushes that drag: turn the input by hand without "
    "load, and see whether grease, preload of the bearings or a seal explains the torque.",
    "load_dependent_friction": "lubrication and surfaces of ring pins, output pins and bushes: "
    "rollers that slide instead of turning, dry or scuffed contacts.",
    "contact_stiffening": "how the load is shared at small torque: clearance of the ring pins and "
    "holes, rollers and discs that touch over a part of their width; a preload would help.",
    "clearance_takeup": "differences of clearance from pin to pin: diameters and positions of ring "
    "pins, output pins and holes.",
    "overload_softening": "what gives way above the load: bolts of the housing and the flange, pin "
    "seats, output pins that bend, the foundation of the rig.",
    "datum_drift": "what moves between the runs: clamping of the output, the angle sensor's "
    "fastening, discs that settle; mark both and compare after a run.",
    "creep": "plastic or printed parts, elastomers, glued joints and clamped bushes that go on "
    "yielding under a held load.",
    "phase_dependent_compliance": "the pins in contact at the soft positions: one worn, loose or "
    "missing pin, roller or bush.",
    "transmission_error": "profile and run-out: eccentricity of the crank, pitch errors of ring "
    "pins and holes, a disc put in turned.",
    "thermal_drift": "temperature of the drive and the rig: fits that open when warm, an angle "
    "sensor or arm in the draught; let it warm up before the test.",
    "viscous_drag": "amount and grade of the grease or oil, and seals that run in it.",
    "load_asymmetry": "what pulls one way: a hanging weight on one side, a coupling out of line, "
    "flanks of one direction that are worn.",
    "dial_eccentricity": "the centring of the dial or encoder disc on the shaft.",
}
"""By name of the effect; effects that users register have none."""

SLIPPED = "what may have slipped: clamps, couplings and the fastening of the angle sensor."
ZERO = (
    "what moves the zero: clamping of the output, fastening of the angle sensor, warm-up of drive, "
    "sensor and amplifier."
)
PLAY = (
    "parts that seat, wear or loosen: pins, bushes, bolts and couplings; feel the play by hand "
    "before and after a run."
)
COMPLIANCE = "parts that seat, loosen or warm up: bolts, pin seats, bushes, the foundation."
RATE = (
    "the torque signal first: a filter in it, or torque read later or earlier than the angle, "
    "opens a loop with the rate as drag does; then at grease, oil and seals."
)
LOOK_AT_SHAPE = {
    "loop by rate": RATE,
    "loop that opens with the rate": RATE,
    "saturation at the end of the range": "sensor and amplifier at the end of their range, and "
    "stops.",
    "step of the angle": SLIPPED,
    "slip within a run": SLIPPED,
    "slow drift": ZERO,
    "drift within runs": ZERO,
    "wandering of the zero": ZERO,
    "run offsets": ZERO,
    "zero that moves from run to run": ZERO,
    "change of play": PLAY,
    "play that changes from run to run": PLAY,
    "change of compliance": COMPLIANCE,
    "compliance by run": COMPLIANCE,
    "compliance that changes from run to run": COMPLIANCE,
}
"""By name of a shape without a name of its own, or of a class of behaviour that no law follows."""
