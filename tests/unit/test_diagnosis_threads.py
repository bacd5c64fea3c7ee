"""A diagnosis keeps linear algebra to one thread, whatever the process allows."""

from threadpoolctl import threadpool_info, threadpool_limits

import cyclosweep as cs
from tests.support.long_recording import long_recording


def blas_threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_linear_algebra_runs_on_one_thread_while_a_diagnosis_lasts() -> None:
    seen: list[set[int]] = []
    recording = long_recording(400)
    diagnose = cs.diagnose  # loads every library of linear algebra
    with threadpool_limits(limits=2, user_api="blas"):
        diagnose(
            recording,
            cs.Drive.reference_87(),
            full=False,
            progress=lambda _: seen.append(blas_threads()),
        )
        assert blas_threads() == {2}
    assert seen
    assert all(threads == {1} for threads in seen)
