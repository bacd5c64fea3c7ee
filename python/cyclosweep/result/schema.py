"""JSON Schema of ``diagnosis.json``, generated from the types of the answer.

python -m cyclosweep.result.schema docs/diagnosis.schema.json
"""

import dataclasses
import json
import sys
from typing import Any

from cyclosweep.atomic import write_text
from cyclosweep.result import (
    answer,
    calibration,
    effects,
    mismatch,
    plausibility,
    play_and_stiffness,
    proof,
)
from cyclosweep.result.json_form import answer_type
from cyclosweep.result.part import Part

DIALECT = "https://json-schema.org/draft/2020-12/schema"
NO_ENTRIES = {"type": "object", "maxProperties": 0}


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``diagnosis.json``.

    Every key is required except those that are left out where they do not apply. Further keys are
    allowed: they may be added without a new version.
    """
    schema = answer_type().json_schema()
    types = {
        part.__name__: part
        for module in (
            answer,
            calibration,
            effects,
            mismatch,
            plausibility,
            play_and_stiffness,
            proof,
        )
        for part in vars(module).values()
        if isinstance(part, type) and issubclass(part, Part) and part is not Part
    }
    for name, described in schema["$defs"].items():
        _as_written(described, types[name])
    _as_written(schema, answer.Answer)
    return {"$schema": DIALECT, **schema, "title": "cyclosweep.diagnosis/1"}


def _as_written(described: dict[str, Any], part: type[Part]) -> None:
    """Require every key that is always written, and describe how a missing value is written."""
    required = []
    for entry in dataclasses.fields(part):  # type: ignore[arg-type]
        prop = described["properties"][entry.name]
        prop.pop("default", None)
        prop.pop("title", None)
        when_none = entry.metadata.get("when_none")
        if when_none != "left out":
            required.append(entry.name)
        if when_none is not None:
            options = [option for option in prop.pop("anyOf") if option != {"type": "null"}]
            if when_none == "empty":
                prop["anyOf"] = [*options, NO_ENTRIES]
            else:
                prop |= options[0]
    described["required"] = required


def main() -> None:
    """Write the schema to the file that is named on the command line."""
    text = json.dumps(json_schema(), indent=1, ensure_ascii=False)
    write_text(sys.argv[1], text + "\n")


if __name__ == "__main__":
    main()
