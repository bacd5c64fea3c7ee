# Everything a person types: set up, show, test, measure.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
DEMO_OUT ?= out/demo
export PIP_CONSTRAINT := $(CURDIR)/constraints.txt
export PIP_DISABLE_PIP_VERSION_CHECK := 1
SOURCES := Cargo.toml Cargo.lock pyproject.toml constraints.txt $(shell find rust -name '*.rs')

.PHONY: help env demo test test-rust test-python test-grid lint bench docs golden clean
.DEFAULT_GOAL := help

help:
	@echo "make demo    set up, sweep 1,050,000 variants to Parquet, validate the 87:1 case"
	@echo "make test    set up, run all tests"
	@echo "make test-grid  closed form against a 0.01 deg grid on 10,000 random drives, some minutes"
	@echo "make lint    rustfmt, clippy, ruff, mypy, stubtest"
	@echo "make bench   speed and memory beside opponents, written to docs/performance.md"
	@echo "make docs    regenerate the tables in docs that come from code"
	@echo "make golden  regenerate the golden values (read the diff before committing it)"

env: $(VENV)/.ready

$(VENV)/.ready: $(SOURCES)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet "maturin>=1.9,<2" pip
	. $(BIN)/activate && maturin develop --release --locked --quiet --extras test,lint,report,dask,challenge
	touch $@

demo: env
	$(BIN)/cyclosweep sweep examples/grid-87.toml --out $(DEMO_OUT)
	$(BIN)/cyclosweep validate

test: test-rust test-python

test-rust:
	cargo test --release --locked --quiet

test-python: env
	$(BIN)/python -m pytest

test-grid: env
	CYCLOSWEEP_GRID_DRIVES=10000 $(BIN)/python -m pytest tests/property/test_active_pins_grid.py

lint: env
	cargo fmt --check
	cargo clippy --release --locked --quiet --all-targets --features python -- -D warnings
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest cyclosweep._core

bench: env
	. $(BIN)/activate && maturin develop --release --locked --quiet --extras bench
	$(BIN)/python benches/run.py --full
	$(BIN)/python benches/instructions.py

docs: env
	$(BIN)/python docs/generate.py

golden: env
	$(BIN)/python -m tests.golden.regenerate

clean:
	rm -rf target $(VENV) out
