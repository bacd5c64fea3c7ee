"""The true model's own held-out error against a fit that is repeated many times."""

import numpy as np

from cyclosweep_challenge import make_case


def test_with_nothing_missing_it_is_the_spread_of_a_straight_line_s_prediction() -> None:
    case = make_case(8, samples=400)
    recording, program = case.recording, case.program
    torque, later = recording["torque_nm"].to_numpy(), program["torque_nm"].to_numpy()

    def columns(t: np.ndarray) -> np.ndarray:
        return np.column_stack([np.ones_like(t), np.sign(t), t])

    rng = np.random.default_rng(2)
    solve = np.linalg.pinv(columns(torque))
    errors = [columns(later) @ (solve @ rng.normal(0.0, 0.2, torque.size)) for _ in range(2000)]
    expected = float(np.sqrt(np.mean(np.square(errors))))
    assert abs(case.truth["held_out_fitting_rms_deg"] / expected - 1.0) < 0.05


def test_unseen_positions_cost_the_true_model_something() -> None:
    plain = make_case(8, samples=800).truth["held_out_fitting_rms_deg"]
    waves = make_case(8, effects=("transmission_error",), d=10.0, samples=800).truth
    assert waves["held_out_fitting_rms_deg"] > 1.5 * plain
