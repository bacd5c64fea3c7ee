# Everything a person types: set up, show, test, measure.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
DEMO_OUT ?= out/demo
TEST_PROCESSES ?= -n 2 --dist worksteal
PROOF_OUT ?= build/proof
PROOF_SEED ?= 500000
PROOF_FLAGS ?=
RECORD_OUT ?= build/record
RECORD_SEED ?= 600000
RECORD_FLAGS ?=
CAMPAIGN_OUT ?= build/campaign
CAMPAIGN_SEED ?= 1100000
CAMPAIGN_SCALE ?= 1
CAMPAIGN_FLAGS ?=
CONTEST_OUT ?= build/contest
CONTEST_SEED ?= 800000
CONTEST_POOR_OUT ?= build/contest-poor
CONTEST_POOR_SEED ?= 900000
SAME_OUT ?= build/same-diagnosis
SAME_CASES ?= 300
SAME_FLAGS ?=
SCOREBOARD_OUT ?= build/scoreboard
SCOREBOARD_FLAGS ?=
WHEEL_OUT ?= build/wheel
RECORD := $(BIN)/python -m cyclosweep_challenge.record --drive examples/measured-13-to-1/drive.toml
export PIP_CONSTRAINT := $(CURDIR)/constraints.txt
export PIP_DISABLE_PIP_VERSION_CHECK := 1
SOURCES := Cargo.toml Cargo.lock pyproject.toml constraints.txt $(shell find rust -name '*.rs')

.PHONY: help env demo test test-rust test-python test-grid lint bench bench-ten-million disc docs golden coverage proof \
	proof-record proof-faint proof-contest proof-contest-poor same-diagnosis scoreboard wheel site clean
.DEFAULT_GOAL := help

help:
	@echo "make demo    set up, sweep 1,050,000 variants to Parquet, validate the 87:1 case, report the study"
	@echo "make test    set up, run all tests"
	@echo "make test-grid  closed form against a 0.01 deg grid on 10,000 random drives, some minutes"
	@echo "make lint    rustfmt, clippy, rustdoc, ruff, mypy, stubtest, types of the blocks of docs"
	@echo "make coverage  the Python tests once more, with the share of lines and branches they run"
	@echo "make bench   speed and memory beside opponents, written to docs/performance.md"
	@echo "make bench-ten-million  1e7 variants of the component model to Parquet, interrupted and resumed"
	@echo "make disc    what a disc's own flexibility adds, by plane finite elements; about five minutes"
	@echo "make proof   a sample of the proof, with another seed, beside the figures of record; about ten minutes"
	@echo "make proof-record  the record across both generators and proof/rigs.md; one to three hours, goes on where it stopped"
	@echo "make proof-faint  the record of faint effects and proof/proof.md; hours, goes on where it stopped"
	@echo "make proof-contest  the contest with the opponents once more and proof/contest.md; about two hours"
	@echo "make proof-contest-poor  the same on poor programmes alone and proof/contest-poor.md; about two hours"
	@echo "make same-diagnosis OTHER=DIR  whether this code and another checkout (set up) diagnose the same"
	@echo "make scoreboard  recordings of real devices and made ones, and which answers are right; about half an hour"
	@echo "make wheel   build the wheel for this kind of machine, install it away from any compiler, use it"
	@echo "make docs    regenerate what in docs and proof comes from code or from the figures of record"
	@echo "make site    the documentation as pages that open without a server: build/site/index.html; make docs does it too"
	@echo "make clean   delete target, $(VENV) and out; records of the proof in build stay"
	@echo "make golden  regenerate the golden values (read the diff before committing it)"

env: $(VENV)/.ready

# pip reads dependency groups since 25.1; the one that comes with Python 3.11 is older.
$(VENV)/.ready: $(SOURCES)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --group dev
	. $(BIN)/activate && PIP_QUIET=1 maturin develop --release --locked --quiet --extras report,dask,challenge,formats
	touch $@

demo: env
	$(BIN)/cyclosweep sweep examples/grid-87.toml --out $(DEMO_OUT)
	$(BIN)/cyclosweep validate
	$(BIN)/cyclosweep report $(DEMO_OUT) --out $(DEMO_OUT)-report.html
	@echo "Open $(DEMO_OUT)-report.html in a browser; it needs no network."

test: test-rust test-python

test-rust:
	cargo test --release --locked --quiet

# One process a core, so one thread for the linear algebra of each.
test-python: env
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest $(TEST_PROCESSES)

coverage: env
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest $(TEST_PROCESSES) --cov --cov-report=term:skip-covered

test-grid: env
	CYCLOSWEEP_GRID_DRIVES=10000 $(BIN)/python -m pytest tests/property/test_active_pins_grid.py

lint: env
	cargo fmt --check
	cargo clippy --release --locked --quiet --all-targets --features python -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps --locked --quiet --features python
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest cyclosweep._core
	$(BIN)/python docs/check_types.py

bench: env
	$(BIN)/python -m pip install --quiet --group bench
	$(BIN)/python -m pip install --quiet --no-deps cycloidgen
	$(BIN)/python benches/run.py --full
	$(BIN)/python benches/dynamics.py
	$(BIN)/python benches/instructions.py

# Some minutes; make bench then shows the record in docs/performance.md.
bench-ten-million: env
	$(BIN)/python benches/ten_million.py

disc: env
	$(BIN)/python -m pip install --quiet --group disc
	cd benches && ../$(BIN)/python -m disc

# The loops of a real drive take part where CYCLOSWEEP_MEASURED names the folder of their files.
proof: env
	$(RECORD) --subset --fresh --out $(PROOF_OUT) --seed $(PROOF_SEED) --verify 20 --against proof/proof.json $(PROOF_FLAGS)

# The scoreboard of real recordings stands beside it where it was made: make scoreboard.
proof-record: env
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m cyclosweep_challenge.campaign \
		--out $(CAMPAIGN_OUT) --seed $(CAMPAIGN_SEED) --scale $(CAMPAIGN_SCALE) --docs proof --verify 50 \
		--before proof/proof.json --scoreboard $(SCOREBOARD_OUT)/scoreboard.json $(CAMPAIGN_FLAGS)

proof-faint: env
	$(RECORD) --out $(RECORD_OUT) --seed $(RECORD_SEED) --docs proof --verify 50 $(RECORD_FLAGS)

proof-contest: env
	$(RECORD) --contest --out $(CONTEST_OUT) --seed $(CONTEST_SEED) --docs proof --verify 50 $(RECORD_FLAGS)

proof-contest-poor: env
	$(RECORD) --contest-poor --out $(CONTEST_POOR_OUT) --seed $(CONTEST_POOR_SEED) --docs proof --verify 50 $(RECORD_FLAGS)

same-diagnosis: env
	test -x "$(OTHER)/$(BIN)/python" || { echo "OTHER=DIR: a checkout in which make env has run"; exit 2; }
	rm -rf $(SAME_OUT)
	$(BIN)/python proof/same_diagnosis.py make $(SAME_OUT)/recordings --cases $(SAME_CASES)
	$(OTHER)/$(BIN)/python proof/same_diagnosis.py run $(SAME_OUT)/recordings $(SAME_OUT)/other.json $(SAME_FLAGS)
	$(BIN)/python proof/same_diagnosis.py run $(SAME_OUT)/recordings $(SAME_OUT)/here.json $(SAME_FLAGS)
	$(BIN)/python proof/same_diagnosis.py compare $(SAME_OUT)/other.json $(SAME_OUT)/here.json

# Measured recordings are read from the folder that CYCLOSWEEP_SHARED names (default ../shared).
scoreboard: env
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m cyclosweep_challenge.scoreboard --out $(SCOREBOARD_OUT) $(SCOREBOARD_FLAGS)

# For Python 3.11 and later; some minutes, most of them link-time optimisation.
wheel: env
	rm -rf $(WHEEL_OUT)
	. $(BIN)/activate && maturin build --profile dist --locked --quiet --out $(WHEEL_OUT)
	$(BIN)/python tests/support/try_wheel.py $(WHEEL_OUT)

docs: env
	$(BIN)/python docs/generate.py
	$(BIN)/python -m cyclosweep_challenge.record --pages proof
	test ! -f proof/rigs.json || $(BIN)/python -m cyclosweep_challenge.campaign --page proof
	$(MAKE) site

# Every warning, such as a link that leads nowhere, is an error.
site: env
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

golden: env
	$(BIN)/python -m tests.golden.regenerate

clean:
	rm -rf target $(VENV) out
