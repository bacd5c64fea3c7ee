"""The command line: what each command takes and prints; the work is done elsewhere."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import sys
from typing import Annotated, NoReturn, cast

import typer

from cyclosweep import __version__, plugins
from cyclosweep.cli import (
    best,
    challenge,
    diagnose,
    dynamics,
    evaluate,
    export,
    feasible,
    inspect,
    nearest,
    new,
    pick,
    plot,
    report,
    robust,
    sensitivity,
    show,
    simulate,
    sweep,
    torque_twist,
    validate,
)
from cyclosweep.cli.output import (
    INTERRUPTED,
    fail,
    is_interruption,
    keep_interruptions,
    survive_encoding,
)
from cyclosweep.errors import DesignError, InputError, SweepError

__all__ = ["main"]

# The exception of typer for wrong options; typer may hold its own copy of click.
_UsageError = cast(type[Exception], typer.BadParameter.__bases__[0])

READER_ENDED = 141
"""Exit status where the reader of a pipe has ended: 128 and the number of SIGPIPE, as of shells."""

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Sweep, validate and diagnose the torsional compliance of cycloidal gear drives.",
)
app.command()(validate.validate)
app.command()(sweep.sweep)
app.command()(sweep.shard)
app.command()(evaluate.evaluate)
app.command()(new.new)
app.command()(show.show)
app.command()(best.best)
app.command()(pick.pick)
app.command()(nearest.nearest)
app.command()(feasible.feasible)
app.command()(sensitivity.sensitivity)
app.command()(robust.robust)
app.command()(report.report)
app.command()(simulate.simulate)
app.command()(torque_twist.torque_twist)
app.command()(plot.plot)
app.command()(inspect.inspect)
app.command()(diagnose.diagnose)
app.command()(export.export)
app.command()(dynamics.modes)
app.command()(dynamics.shock)
app.command()(challenge.challenge)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"cyclosweep {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    plugin: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MODULE",
            help="Import a module of your own first, with columns, constraints or effects; the "
            "option may stand anywhere.",
        ),
    ] = None,
) -> None:
    """Sweep, validate and diagnose the torsional compliance of cycloidal gear drives."""


def _with_plugins(arguments: list[str]) -> list[str]:
    """Import the modules that ``--plugin`` names and return the other arguments."""
    rest: list[str] = []
    given = iter(arguments)
    for argument in given:
        if argument == "--":
            return [*rest, argument, *given]
        name, sign, module = argument.partition("=")
        if name != "--plugin":
            rest.append(argument)
            continue
        module = module if sign else next(given, "")
        if not module:
            raise InputError("--plugin: found nothing after it, expected a module or a .py file")
        plugins.load(module)
    return rest


MACHINE_ERRORS = frozenset(
    {
        errno.ENOSPC,
        errno.EDQUOT,
        errno.EFBIG,
        errno.EIO,
        errno.ENOMEM,
        errno.EMFILE,
        errno.ENFILE,
        None,
    }
)
"""Errors of the machine and not of a path that was given; None where no number is known."""


def _end_without_reader() -> NoReturn:
    """End quietly where the program that reads the output has ended, as `head` does."""
    with contextlib.suppress(OSError):  # else Python's own flush at the end fails
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(READER_ENDED)


def _usage_message(error: Exception) -> str:
    """What is wrong with the arguments; a number below zero is no unknown option."""
    option = str(getattr(error, "option_name", ""))
    if re.fullmatch(r"-\d", option):
        given = next(each for each in sys.argv[1:] if each.startswith(option))
        return f"found {given}, expected a number that is not below zero"
    return str(getattr(error, "format_message", error.__str__)())


def main() -> None:
    """Run the command line; every error is one line and an exit status."""
    survive_encoding()
    keep_interruptions()
    try:
        arguments = _with_plugins(sys.argv[1:])
        status = app(args=arguments or ["--help"], standalone_mode=False)
        sys.stdout.flush()
    except _UsageError as error:
        message = _usage_message(error)
        fail(f"{' '.join(message.split()).rstrip('.')}; see --help", 2)
    except typer.Abort:
        fail("interrupted", INTERRUPTED)
    except (InputError, DesignError) as error:
        if is_interruption(error):
            sys.exit(INTERRUPTED)
        fail(error, 2)
    except SweepError as error:
        fail(error, 1)
    except BrokenPipeError:
        _end_without_reader()
    except SystemExit as stop:
        # So typer and rich end where the reader has; elsewhere a command has said its status.
        if isinstance(stop.__context__, BrokenPipeError):
            _end_without_reader()
        raise
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        fail(f"{where}{error.strerror or error}", 1 if error.errno in MACHINE_ERRORS else 2)
    except ImportError as error:
        if is_interruption(error):
            sys.exit(INTERRUPTED)
        raise
    else:
        sys.exit(status if isinstance(status, int) else 0)
