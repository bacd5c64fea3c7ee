"""Every Python block of the page on the challenge runs by itself."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "challenge.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


@pytest.mark.parametrize("block", BLOCKS)
def test_block_runs(block: str) -> None:
    exec(compile(block, str(PAGE), "exec"), {})
