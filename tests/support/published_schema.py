"""The published JSON Schema of diagnosis.json, and a check of an answer against it."""

import json
from pathlib import Path
from typing import Any

import jsonschema

from cyclosweep.result import answer_of, content_of

PUBLISHED = Path(__file__).parents[2] / "docs" / "diagnosis.schema.json"


def check_content(content: dict[str, Any]) -> None:
    """Hold the content of a diagnosis.json against the schema, and read it back unchanged."""
    schema = json.loads(PUBLISHED.read_text("utf-8"))
    jsonschema.Draft202012Validator(schema).validate(content)
    assert content_of(answer_of(content)) == content
