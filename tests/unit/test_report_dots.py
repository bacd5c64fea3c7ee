"""What the residual panels of a report draw: dots on the headline's footing, without the play."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.report.charts import Band, Cells, Points
from cyclosweep.report.figures import all_figures
from cyclosweep.report.html import page
from tests.support.long_recording import friction, long_recording


@pytest.fixture(scope="module")
def long() -> cs.Diagnosis:
    recording = long_recording(20_000, [friction(0.4)], noise_deg=0.05)
    return cs.diagnose(recording, cs.Drive.reference_87())


def test_dots_of_a_thinned_recording_scatter_as_its_rows_do(long: cs.Diagnosis) -> None:
    thinning = long.answer.thinning
    assert thinning is not None
    assert thinning.averaged > 1
    main = all_figures(long.report_data())[0]
    (after,) = [p.panel for p in main.panels if p.panel.title.startswith("Residual after")]
    dots = np.concatenate([s.y for s in after.series if isinstance(s, Points)])
    assert np.std(dots) == pytest.approx(long.answer.noise.sigma_deg, rel=0.2)
    assert f"mean of {thinning.averaged} neighbouring samples" in main.caption


def test_readings_on_the_way_through_the_play_set_no_scale(long: cs.Diagnosis) -> None:
    figures = {figure.key: figure for figure in all_figures(long.report_data())}
    for placed in figures["profiles"].panels:
        means = [s.y for s in placed.panel.series if isinstance(s, Points)]
        assert max(float(np.abs(m).max(initial=0.0)) for m in means) < 0.7
    (before, after) = [s for p in figures["map"].panels for s in p.panel.series]
    assert isinstance(before, Cells)
    assert isinstance(after, Cells)
    assert before.limit < 0.7
    assert np.nanmax(np.abs(after.values)) < 0.1


def test_a_dozen_readings_show_no_empty_rows_and_no_profiles_of_two_points() -> None:
    rows = np.unique(np.linspace(0, 2900, 13).astype(int))
    recording = long_recording(3000)
    assert recording.angle_deg is not None
    few = cs.Recording.from_arrays(
        recording.torque_nm[rows], recording.angle_deg[rows], run=recording.run[rows]
    )
    found = cs.diagnose(few, cs.Drive.reference_87())
    text = page(found.report_data())
    assert "energy lost in one cycle" not in text
    for figure in all_figures(found.report_data()):
        if figure.key == "profiles":
            for placed in figure.panels:
                bands = [s for s in placed.panel.series if isinstance(s, Band)]
                assert sum(len(b.x) for b in bands) >= 3
