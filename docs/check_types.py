"""Type-check every Python block of README and docs, as the editor of a reader does."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

from mypy import api

ROOT = Path(__file__).resolve().parents[1]
BLOCKS = ROOT / "build" / "doc-blocks"
_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
RUN_WHOLE = ("tutorials", "how-to")
"""Folders of pages whose blocks build on each other."""

# The types of SciPy know no function that is called with many points at once; and an example goes
# on where a program would ask whether a recording has an angle or a diagnosis a model.
CONFIGURATION = """
[mypy]
mypy_path = $MYPY_CONFIG_FILE_DIR/../../python
ignore_missing_imports = True
check_untyped_defs = True
strict_optional = False
follow_imports = silent
plugins = pydantic.mypy
[mypy-scipy.*]
follow_imports = skip
follow_imports_for_stubs = True
"""


def python_alone(text: str) -> str:
    """Return a page's Python blocks on their own lines, with empty lines for the rest."""
    lines = [""] * (text.count("\n") + 1)
    for block in _BLOCK.finditer(text):
        first = text[: block.start(1)].count("\n")
        code = block[1].splitlines()
        lines[first : first + len(code)] = code
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write a module for each block, check all of them, and name the page where one is wrong."""
    shutil.rmtree(BLOCKS, ignore_errors=True)
    BLOCKS.mkdir(parents=True)
    configuration = BLOCKS / "mypy.ini"
    configuration.write_text(CONFIGURATION)
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        name = "_".join(page.relative_to(ROOT).with_suffix("").parts).replace("-", "_")
        text = page.read_text("utf-8")
        if page.parent.name in RUN_WHOLE:
            (BLOCKS / f"{name}.py").write_text(python_alone(text))
            continue
        for number, block in enumerate(_BLOCK.finditer(text)):
            # Empty lines in front, so that the lines of a message are those of the page.
            before = text[: block.start(1)].count("\n")
            (BLOCKS / f"{name}_{number}.py").write_text("\n" * before + block[1])
    modules = sorted(map(str, BLOCKS.glob("*.py")))
    cache = str(ROOT / ".mypy_cache" / "doc-blocks")
    out, errors, status = api.run(
        ["--config-file", str(configuration), "--cache-dir", cache, *modules]
    )
    print(out + errors, end="")
    sys.exit(status)


if __name__ == "__main__":
    main()
