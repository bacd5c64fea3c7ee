"""What the site has beyond the folder docs: the proof, the examples, the commands, equations."""

from __future__ import annotations

import html
import logging
import posixpath
import re
from pathlib import Path

import latex2mathml.converter
import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
_LINK = re.compile(r"\]\((?![a-z]+:|#|<)([^)#\s]+)(#[^)]*)?\)")
_FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)

_TITLES = {
    "design": "Drives",
    "sweep": "Spaces, studies, sweeps",
    "explore": "Choosing",
    "choose": "Choosing",
    "recording": "Recordings and diagnosis",
    "diagnosis": "Recordings and diagnosis",
    "simulation": "Recordings and diagnosis",
    "dynamics": "Dynamics",
    "reference": "Validation",
    "errors": "Errors",
    "cad": "Drawings",
    "figures": "Pictures",
    "": "Others",
}
_SHIM = "https://unpkg.com/iframe-worker/shim"
"""What the theme would fetch for the search in pages opened from a folder."""

_FETCHED = re.compile(
    r'<(?:script|img|iframe)[^>]*src="(https?://[^"]+)|<link[^>]*href="(https?://[^"]+)'
)
_ROLE = re.compile(r":(?:class|meth|func|data|mod|attr|exc):(<code[^>]*>)~?")
_FOOTNOTE = re.compile(r"<p>\.\. \[\d+\] ")


def _in_repository(page: str) -> str:
    """Return where in the repository the page of the site stands."""
    return (
        page if (ROOT / page).exists() and not (ROOT / "docs" / page).exists() else f"docs/{page}"
    )


def _in_site(path: str) -> str:
    """Return where in the site a file of the repository stands; a folder by its list of files."""
    place = path.removeprefix("docs/")
    return f"{place}/index.md" if (ROOT / path).is_dir() else place


def _target(page: str, link: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(_in_repository(page)), link))


def _example_list() -> str:
    lines = ["# Examples", "", "Files that run as they are, from the folder `examples`.", ""]
    for path in sorted((ROOT / "examples").rglob("*")):
        if path.suffix not in (".toml", ".md", ".py", ".csv", ".ipynb"):
            continue
        name = path.relative_to(ROOT / "examples").as_posix()
        first = path.read_text("utf-8").splitlines()[0]
        said = first.strip('#" ') if first.startswith(("#", '"""')) else ""
        lines.append(f"* [`{name}`]({name}){': ' + said if said else ''}")
    return "\n".join(lines) + "\n"


def _command_page() -> str:
    """Return the help of every command, as the terminal shows it in 90 columns."""
    from cyclosweep.cli import app

    group = typer.main.get_command(app)
    context = typer.Context(group, info_name="cyclosweep", terminal_width=90)
    lines = [
        "# Command line",
        "",
        "What `cyclosweep COMMAND --help` says, made when the site is built.",
    ]
    commands = getattr(group, "commands", {})
    for name in sorted(commands):
        inner = typer.Context(commands[name], info_name=name, parent=context, terminal_width=90)
        lines += ["", f"## {name}", "", "```text", commands[name].get_help(inner), "```"]
    return "\n".join(lines) + "\n"


def _every_public_name() -> str:
    """Return the directives that show the docstring of every public name, by what it is for."""
    import cyclosweep as cs

    groups: dict[str, list[str]] = {title: [] for title in dict.fromkeys(_TITLES.values())}
    for name in cs.__all__:
        if not name.startswith("_"):
            folder = getattr(cs, name).__module__.split(".")[1]
            groups[_TITLES.get(folder, "Others")].append(name)
    lines = []
    for title, names in groups.items():
        lines += [f"## {title}", ""] if names else []
        lines += [line for name in sorted(names) for line in (f"::: cyclosweep.{name}", "")]
    return "\n".join(lines)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the proof's pages, the examples, the commands, and every file that a page links to."""
    wanted = {path.relative_to(ROOT).as_posix() for path in (ROOT / "proof").glob("*.md")}
    wanted |= {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "examples").rglob("*")
        if path.suffix in (".toml", ".md", ".py", ".csv", ".ipynb")
    }
    pages = [file.src_uri for file in files.documentation_pages()] + sorted(wanted)
    for page in pages:
        path = ROOT / _in_repository(page)
        if path.suffix != ".md":
            continue
        for match in _LINK.finditer(_FENCE.sub("", path.read_text("utf-8"))):
            target = _target(page, match[1])
            if not target.startswith("docs/") and (ROOT / target).is_file():
                wanted.add(target)
    for place in sorted(wanted):
        files.append(File(place, str(ROOT), config.site_dir, config.use_directory_urls))
    for place, text in (
        ("examples/index.md", _example_list()),
        ("reference/command-line.md", _command_page()),
    ):
        files.append(File.generated(config, place, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Point links between files of the repository to where these stand in the site."""
    place = page.file.src_uri
    if page.file.generated_by:
        return markdown
    markdown = markdown.replace("<!-- every public name -->", _every_public_name())

    def moved(match: re.Match[str]) -> str:
        target = _in_site(_target(place, match[1]))
        link = posixpath.relpath(target, posixpath.dirname(place) or ".")
        return f"]({link}{match[2] or ''})"

    return _LINK.sub(moved, markdown)


def on_page_content(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn equations into MathML, which browsers show without a script; drop marks of Sphinx."""

    def mathml(match: re.Match[str]) -> str:
        display = "block" if match[1] == "div" else "inline"
        formula = latex2mathml.converter.convert(html.unescape(match[2]), display=display)
        return f'<{match[1]} class="arithmatex">{formula}</{match[1]}>'

    return _FOOTNOTE.sub("<p>", _ROLE.sub(r"\1", _EQUATION.sub(mathml, content)))


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """Take the search's script from the site, and warn of anything that a reader would fetch."""
    up = posixpath.relpath("search-worker.js", posixpath.dirname(page.file.dest_uri) or ".")
    output = output.replace(_SHIM, up)
    for match in _FETCHED.finditer(output):
        logging.getLogger("mkdocs.site").warning(
            "%s: found %s, expected nothing from a network", page.file.src_uri, match[1] or match[2]
        )
    return output


def on_post_template(output: str, template_name: str, config: MkDocsConfig) -> str:
    """Take the search's script from the site in the page of lost links, too."""
    return output.replace(_SHIM, "search-worker.js")
