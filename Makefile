# Everything runs in .venv, which any target makes first. `make test KINEMATICS=numpy` runs the
# whole suite on the kinematics that Windows uses.
PYTHON ?= python3
KINEMATICS ?=
BIN := .venv/bin

.PHONY: demo test bench simulator lint format lock clean

demo: .venv/installed
	$(BIN)/python tools/system_packages.py demo
	$(BIN)/rastrainer demo --output build/demo

test: .venv/installed
	$(BIN)/python tools/system_packages.py test
	RASTRAINER_KINEMATICS=$(KINEMATICS) $(BIN)/python -m pytest -n 2 -q

bench: .venv/bench-installed
	$(BIN)/python tools/system_packages.py test
	$(BIN)/python -m Testing.benchmarks

simulator: .venv/installed
	$(BIN)/rastrainer simulator

lint: .venv/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

format: .venv/installed
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# Hashes, but no addresses: the lock holds at whatever index a site uses.
lock: .venv/installed
	$(BIN)/pip install -q uv
	$(BIN)/uv pip compile pyproject.toml --extra test $(LOCK) -o requirements.lock
	$(BIN)/uv pip compile pyproject.toml --extra bench --constraints requirements.lock $(LOCK) -o requirements-bench.lock

LOCK := --quiet --universal --python-version 3.10 --generate-hashes --no-emit-index-url \
	--no-annotate --no-header --upgrade

.venv/bin/python:
	$(PYTHON) -m venv .venv || (echo "RASTrainer needs Python 3.10 or newer with the venv module (Debian: python3-venv)." >&2; exit 1)

.venv/installed: .venv/bin/python requirements.lock pyproject.toml
	$(BIN)/python -m pip install -q --require-hashes -r requirements.lock
	$(BIN)/python -m pip install -q --no-deps --no-build-isolation -e .
	touch $@

.venv/bench-installed: .venv/installed requirements-bench.lock
	$(BIN)/python -m pip install -q --require-hashes -r requirements-bench.lock
	touch $@

clean:
	rm -rf build .venv
