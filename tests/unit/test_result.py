"""The answer of a diagnosis as JSON and back, and the schema that is published of it."""

import dataclasses
import json
from typing import Any

import jsonschema
import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.result import (
    Answer,
    EffectParameter,
    FoundEffect,
    Mismatch,
    Region,
    Size,
    answer_of,
    content_of,
)
from cyclosweep.result import content as typed
from cyclosweep.result.json_form import json_text
from cyclosweep.result.schema import json_schema
from tests.support.published_schema import PUBLISHED, check_content


def test_the_published_schema_is_that_of_the_types() -> None:
    assert json.loads(PUBLISHED.read_text("utf-8")) == json_schema()


def test_every_key_has_a_description() -> None:
    schema = json_schema()
    for part in [schema, *schema["$defs"].values()]:
        assert part["description"]
        for name, prop in part["properties"].items():
            assert prop.get("description"), name


def test_an_answer_of_defaults_has_every_key_and_keeps_the_schema() -> None:
    content = content_of(Answer(verdict="DATA_FAULT"))
    check_content(content)
    left_out = {"unknown", "drift", "change", "thinning", "play_and_stiffness"}
    assert set(content) == {entry.name for entry in dataclasses.fields(Answer)} - left_out
    assert content["self_check"] == content["next_experiment"] == {}


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"verdict": "MAYBE"}, "verdict"),
        ({"noise": {"sigma_deg": "little"}}, "noise.sigma_deg"),
        ({"effects": [{"name": "creep"}]}, "effects.0.size_deg"),
    ],
)
def test_a_wrong_value_is_named(change: dict[str, Any], where: str) -> None:
    content = content_of(Answer(verdict="DATA_FAULT")) | change
    with pytest.raises(cs.InputError, match=where):
        answer_of(content)
    with pytest.raises(jsonschema.ValidationError):
        check_content(content)


def test_a_missing_verdict_is_named() -> None:
    with pytest.raises(cs.InputError, match="verdict"):
        answer_of({})


def test_numbers_that_json_has_not_become_null() -> None:
    answer = answer_of({"verdict": "IDENTIFIED", "noise": {"sigma_deg": 0.2}})
    noise = dataclasses.replace(answer.noise, sigma_deg=np.float64("nan"))
    content = json.loads(json_text(dataclasses.replace(answer, noise=noise)))
    assert content["noise"]["sigma_deg"] is None


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (typed.EffectContent, FoundEffect),
        (typed.ParameterContent, EffectParameter),
        (typed.SizeContent, Size),
        (typed.RegionContent, Region),
        (typed.MismatchContent, Mismatch),
    ],
)
def test_types_of_the_dictionaries_have_the_fields_of_the_parts(content: type, part: type) -> None:
    assert list(content.__annotations__) == [field.name for field in dataclasses.fields(part)]
