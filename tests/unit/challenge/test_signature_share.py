"""What a library effect can represent of a signature is measured right."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from cyclosweep.simulation.effects import find

TOOL = Path(__file__).parents[3] / "proof" / "signature_share.py"


@pytest.fixture(scope="module")
def tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("signature_share", TOOL)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["signature_share"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("part", [0.0, 0.25])
def test_what_is_put_beside_a_library_signature_is_what_is_left(
    tool: ModuleType, part: float
) -> None:
    """A signature of the library, off its grid, and a part of known norm that no shape holds."""
    given = tool.make_signature("load_asymmetry", "poor", 3)
    effect = find("load_asymmetry")
    own = effect.columns(given.history, {"power": 1.234})[:, 0]
    own -= given.span @ (given.span.T @ own)
    other = np.random.default_rng(1).normal(size=own.size)
    directions = np.column_stack([given.span, own / np.linalg.norm(own)])
    other -= directions @ np.linalg.lstsq(directions, other)[0]
    mixed = np.sqrt(1.0 - part**2) * own / np.linalg.norm(own)
    mixed += part * other / np.linalg.norm(other)
    single, joined = tool.share_left(tool.Signature(mixed, given.span, given.history), effect)
    assert single == pytest.approx(part, abs=0.01)
    assert joined == single


def test_a_sign_that_physics_forbids_is_not_used(tool: ModuleType) -> None:
    given = tool.make_signature("overload_softening", "poor", 3)
    turned = tool.Signature(-given.projected_deg, given.span, given.history)
    effect = find("overload_softening")
    assert tool.share_left(given, effect)[0] < 0.1
    assert tool.share_left(turned, effect)[0] > 0.9
