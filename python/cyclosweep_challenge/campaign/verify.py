"""Check a campaign from its folder: log, order, answers, diagnoses, and recordings made again."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from cyclosweep_challenge.campaign.item import Item, Part
from cyclosweep_challenge.campaign.making import answer_of, make_item
from cyclosweep_challenge.campaign.run import Campaign
from cyclosweep_challenge.record.run import diagnoses_hash
from cyclosweep_challenge.record.verify import earliest, verify_log
from cyclosweep_challenge.trial.seal import SealError, reveal_answer, root_hash


def verify_campaign(campaign: Campaign, every: int = 1) -> list[str]:
    """Check that a campaign is what it says it is.

    The log's lines must follow from one another and each slice be published before it is diagnosed;
    answers and diagnoses must be those of the log; recordings and answers must come out the same
    when made again from the seed.

    Parameters
    ----------
    campaign : Campaign
        The campaign.
    every : int
        Make each so many-th recording of a part again only; the rest is checked for all.

    Returns
    -------
    list of str
        What does not fit; empty if all does.
    """
    complaints = verify_log(campaign.ledger.file)
    if complaints:
        return complaints
    for part in campaign.parts:
        plan = campaign.done(part)
        complaints += _roots(campaign, part, plan)
        for item in plan[::every]:
            complaints += _again(campaign, part, item)
    return complaints


def _roots(campaign: Campaign, part: Part, plan: Sequence[Item]) -> list[str]:
    """Slices whose answers or diagnoses are not those of the log, or were diagnosed too early."""
    folders = campaign.folders(part)
    hashes = folders.hashes()
    complaints = []
    published: dict[int, str] = {}
    for line in campaign.ledger.lines:
        if line.get("part") != part.name or line["last"] > len(plan):
            continue
        here, words = plan[line["first"] : line["last"]], f"{part.name} from {line['first']}"
        if line["event"] == "sealed":
            published[line["first"]] = line["time"]
            if root_hash((i.key, hashes.get(i.key, "")) for i in here) != line["root"]:
                complaints.append(f"{words}: answers are not those that were published")
        elif line["event"] == "diagnosed":
            if diagnoses_hash(here, folders) != line["root"]:
                complaints.append(f"{words}: diagnoses are not those that were kept")
            if earliest(here, folders) < published[line["first"]]:
                complaints.append(f"{words}: diagnosed before its answers were published")
    return complaints


def _again(campaign: Campaign, part: Part, item: Item) -> list[str]:
    """Make one recording again and compare it with its answer."""
    folders = campaign.folders(part)
    words = f"{part.name}/{item.key}"
    try:
        answer = reveal_answer(folders.answer(item.key), folders.hashes()[item.key])
    except (SealError, OSError) as error:
        return [f"{part.name}: {error}"]
    case = make_item(item)
    with TemporaryDirectory() as scratch:
        files = sorted(case.write(Path(scratch), program=part.predicted).iterdir())
        again = answer_of(case, files, predicted=part.predicted)
        complaints = [
            f"{words}/{f.name}: not what the seed gives"
            for f in files
            if hashlib.sha256(f.read_bytes()).hexdigest() != answer["files"].get(f.name)
        ]
    return complaints + [
        f"{words}: the answer's {key!r} is not what the seed gives"
        for key in again
        if key != "files" and answer.get(key) != again[key]
    ]
