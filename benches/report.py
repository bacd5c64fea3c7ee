"""docs/performance.md from measured results: tables, plot, JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from component_model import component_lines

__all__ = ["write_report"]

BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"


def write_report(results: dict[str, Any], folder: Path) -> None:
    """Write ``performance.md`` (between its marks), ``performance.png`` and ``performance.json``.

    Parameters
    ----------
    results : dict
        What ``run.py`` measured.
    folder : Path
        Where to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(results, indent=1)
    (folder / "performance.json").write_text(text + "\n", encoding="utf-8")
    _plot(results, folder / "performance.png")
    page = folder / "performance.md"
    before, after = "# Performance\n\n", "\n"
    if page.exists() and BEGIN in (old := page.read_text(encoding="utf-8")):
        before, after = old.split(BEGIN)[0], old.split(END)[1]
    measured = "\n".join(_lines(results))
    page.write_text(f"{before}{BEGIN}\n{measured}\n{END}{after}", encoding="utf-8")


def _lines(results: dict[str, Any]) -> list[str]:
    machine = results["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
    lines = [
        f"Measured on {machine['date']} by `{results['command']}`: {machine['cores']} cores "
        f"({machine['architecture']}), {machine['memory_gib']} GiB, load {machine['load']:.1f} "
        f"when it began; {versions}. {results['count']:,} variants a run, "
        f"{results['rounds']} alternating runs: the median, the fastest, and the rate of a core in "
        "the run that took least processor time. Ratios compare the last two.",
        "",
        "![Variants a second](performance.png)",
        "",
        "## In memory",
        "",
        *_rate_table(results["memory"], "cyclosweep, kernel, inputs given"),
        "",
        "Largest relative difference from cyclosweep: "
        + ", ".join(f"{name} {value:.0e}" for name, value in results["agreement"].items())
        + " (720 positions: of the mean, which is all a grid resolves).",
        "",
        "## Full grid",
        "",
        *_rate_table(results["grid"], None),
        "",
        "## To Parquet",
        "",
        "| compression | bytes a variant | M variants/s, polars alone | fastest run |",
        "|---|---:|---:|---:|",
    ]
    for row in results["codecs"]:
        lines.append(
            f"| {row['codec']} | {row['bytes_per_variant']:.0f} | {row['rate'] / 1e6:.2f} "
            f"| {row['best'] / 1e6:.2f} |"
        )
    parquet = dict(results["parquet"])
    of_a_core, codec = parquet.pop("share_of_a_core"), parquet.pop("compression")
    of_fastest = parquet.pop("share_of_fastest")
    lines += [
        "",
        *_rate_table(parquet, None),
        "",
        f"Compression of polars: {codec}. The sweep to a dataset, kernel included, runs at "
        f"{of_a_core:.2f} of the rate of polars writing the finished table by processor time; the "
        f"fastest run of each compared, at {of_fastest:.2f}.",
        "",
        "## Filter, select, sink",
        "",
        "| variants | kept | seconds | ns a variant | peak memory over imports |",
        "|---:|---:|---:|---:|---:|",
    ]
    for row in results["streams"]:
        lines.append(
            f"| {row['variants']:,} | {row['rows']:,} | {row['seconds']:.2f} "
            f"| {row['seconds'] / row['variants'] * 1e9:.0f} "
            f"| {row['over_baseline_mib']:.0f} MiB |"
        )
    lines += ["", *component_lines(results["components"])]
    lines += [
        "## Diagnosis",
        "",
        "The whole diagnosis with its report, one run each. A recording of more than 6,000 samples "
        "is thinned ([recordings.md](recordings.md#long-recordings)).",
        "",
        "| samples | missing | verdict | seconds | processor seconds |",
        "|---:|---|---|---:|---:|",
    ]
    for row in results["diagnosis"]:
        missing = ", ".join(row["effects"]).replace("_", " ") or "nothing"
        lines.append(
            f"| {row['samples']:,} | {missing} | {row['verdict']} | {row['seconds']:.1f} "
            f"| {row['cpu_seconds']:.1f} |"
        )
    return lines


def _rate_table(rates: dict[str, Any], against: str | None) -> list[str]:
    ratio = against is not None
    lines = [
        "| | M variants/s | fastest run | a core, by processor time |"
        + (" kernel, inputs given, is ahead by |" if ratio else ""),
        "|---|---:|---:|---:|" + ("---:|" if ratio else ""),
    ]
    for name, row in rates.items():
        cells = [_millions(row[key]) for key in ("rate", "best", "rate_of_a_core")]
        line = f"| {name} | " + " | ".join(cells) + " |"
        if against is not None:
            wall, cpu = (rates[against][key] / row[key] for key in ("best", "rate_of_a_core"))
            line += f" {wall:.2f} (by processor time {cpu:.2f}) |"
        lines.append(line)
    return lines


def _millions(rate: float) -> str:
    if rate == 0.0:
        return ""
    return f"{rate / 1e6:.2f}" if rate > 1e5 else f"{rate / 1e6:.5f}"


def _plot(results: dict[str, Any], path: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    memory = results["memory"]
    names = list(reversed(memory))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.2), layout="constrained")
    left.barh(names, [memory[name]["rate"] for name in names], color="#4477aa")
    left.set_xscale("log")
    left.set_xlabel("variants/s, bench study in memory")
    streams = results["streams"]
    counts = [row["variants"] for row in streams]
    right.plot(counts, [row["over_baseline_mib"] for row in streams], "o-", color="#aa3377")
    right.set_xscale("log")
    right.set_ylim(0, 320)
    right.axhline(300, color="0.7", linewidth=1)
    right.set_xlabel("variants through filter, select, sink")
    right.set_ylabel("peak memory over imports [MiB]")
    figure.savefig(path, dpi=80)
    plt.close(figure)
