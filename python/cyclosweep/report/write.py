"""Writing of a report in the form that the name of its file asks for."""

from pathlib import Path

from cyclosweep.errors import InputError
from cyclosweep.report.data import ReportData
from cyclosweep.report.html import write_html
from cyclosweep.report.png import write_main_png, write_png


def write_report(data: ReportData, path: str | Path) -> Path:
    """Write the report in the form that the name asks for.

    Parameters
    ----------
    data : ReportData
        What to report.
    path : path
        ``*.html``: the page; ``*.png``: the main picture; a name without an ending: a folder of
        all pictures as PNG files.

    Returns
    -------
    Path
        What was written.

    Raises
    ------
    InputError
        The name has another ending, or there is no picture to draw.
    """
    path = Path(path)
    match path.suffix.lower():
        case ".html" | ".htm":
            return write_html(data, path)
        case ".png":
            return write_main_png(data, path)
        case "":
            write_png(data, path)
            return path
    raise InputError(f"{path}: found ending {path.suffix!r}, expected .html, .png or a folder")
