"""Pages of the proof lead to files that exist, and say what their figures say."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[3]
NAMED = ["README.md", "CONTRIBUTING.md", "docs/proof.md", "docs/challenge.md"]
PAGES = [*sorted((ROOT / "proof").glob("*.md")), *(ROOT / name for name in NAMED)]
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)\s]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files(page: Path) -> None:
    links = [link for link in LINK.findall(page.read_text("utf-8")) if "://" not in link]
    missing = [link for link in links if not (page.parent / link).exists()]
    assert missing == []
    assert links or page.stem.endswith("-notes")


@pytest.fixture(scope="module")
def record() -> dict[str, Any]:
    content: dict[str, Any] = json.loads((ROOT / "proof" / "proof.json").read_text())
    return content


@pytest.fixture(scope="module")
def page() -> str:
    return (ROOT / "docs" / "proof.md").read_text("utf-8")


def figures(record: dict[str, Any]) -> dict[str, float]:
    """Value of every figure by its name."""
    return {f["name"]: f["estimate"]["value"] for f in record["figures"]}


@pytest.mark.parametrize("programme", ["rich", "poor"])
def test_naming_on_the_page_is_that_of_the_record(
    record: dict[str, Any], page: str, programme: str
) -> None:
    found = figures(record)
    names = [f"named right, single effect, d = {d}, {programme}" for d in (6, 10, 20)]
    words = " / ".join(f"{found[name]:.2f}" for name in names)
    assert f"| named exactly right, {programme}, d = 6 / 10 / 20 | {words} |" in page


def test_false_alarms_on_the_page_are_those_of_the_record(
    record: dict[str, Any], page: str
) -> None:
    rows = record["tables"]["false_alarms"]
    alarms = sum(round(row["all"]["value"] * row["all"]["count"]) for row in rows)
    cases = sum(row["all"]["count"] for row in rows)
    worst = max(rows, key=lambda row: row["all"]["value"])["all"]
    assert f"| {alarms} of {cases:,}; worst kind of noise {100 * worst['value']:.1f} % " in page
    assert f"(upper bound {100 * worst['high']:.2f} %)" in page


def test_the_code_of_the_record_is_named(record: dict[str, Any], page: str) -> None:
    about = record["record"]
    assert f"`{about['diagnosis'][:16]}…`" in page
    assert f"`{about['rig'][:16]}…`" in page
    assert f"| {about['seed']} |" in page
    assert f"`{about['commit'][:7]}`" in page


def test_the_count_of_missed_targets_leaves_out_what_cannot_be_missed(
    record: dict[str, Any], page: str
) -> None:
    aimed = [
        f
        for f in record["figures"]
        if f["target"] != "none" and not f["name"].startswith("exact aliases called untestable")
    ]
    missed = sum(f["met"] is False for f in aimed)
    assert f"Of {len(aimed)} figures with a target {missed} miss it." in page
