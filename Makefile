# Everything runs in .venv, which any target makes first. `make test KINEMATICS=numpy` runs the
# whole suite on the kinematics that Windows uses; `make test SLOW=7` as on a slow machine, the files
# in another order (7 is the seed; see Testing/slow_machine).
PYTHON ?= python3
KINEMATICS ?=
SLOW ?=
BIN := .venv/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
VENV_PYTHON := $(BIN)/python$(if $(filter Windows_NT,$(OS)),.exe)
UNAME := $(shell uname 2>/dev/null)

.PHONY: demo test soak bench simulator extension extension-repository lint format docs lock audit page clean

demo: .venv/installed
	$(BIN)/python tools/system_packages.py demo
	$(BIN)/rastrainer demo --output build/demo

# Opens the trainee's window where there is a display; else the simulator alone, for browsers.
simulator: .venv/installed page
	$(BIN)/python tools/system_packages.py simulator
	$(BIN)/rastrainer simulator $(if $(or $(DISPLAY),$(filter Windows_NT,$(OS)),$(filter Darwin,$(UNAME))),--desktop)

# OpenBLAS computes in one thread: several in each of many processes only wait for one another, which
# took three times the processors' time.
ONE_THREAD := OPENBLAS_NUM_THREADS=1
# What failed runs once more, alone, if AGAIN is set: see Testing/run_again.py.
AGAIN ?=
RUN_AGAIN := $(if $(AGAIN),-p Testing.run_again)
AS_SLOW := $(if $(SLOW),RASTRAINER_SLOW=$(SLOW) PYTHONPATH=$(CURDIR)/Testing/slow_machine)

# Python keeps what it has compiled, whatever the environment says: hundreds of processes start.
test: .venv/test-installed page
	$(BIN)/python tools/system_packages.py test
	$(ONE_THREAD) PYTHONDONTWRITEBYTECODE= RASTRAINER_KINEMATICS=$(KINEMATICS) $(AS_SLOW) $(BIN)/python -m pytest -n 4 --dist loadfile --no-loadscope-reorder $(RUN_AGAIN) -q

# What takes hours: attacks, crashes, cut links, whole trials in the headset. `make soak PART=3` runs
# one of the parts that `make soak PART=list` lists, each of at most 20 minutes.
PART ?=
soak: .venv/soak-installed page
	$(BIN)/python tools/system_packages.py test
	$(BIN)/python tools/system_packages.py soak
	$(ONE_THREAD) $(BIN)/python -m Testing.soak $(if $(PART),"$(PART)")

bench: .venv/bench-installed page
	$(BIN)/python tools/system_packages.py test
	PYTHONDONTWRITEBYTECODE= $(BIN)/python -m Testing.benchmarks

# What Slicer's extension needs beyond the sources: the simulator's wheel, put beside its module.
extension: .venv/installed
	$(BIN)/python tools/simulator_wheel.py

# The repository that Slicer's Extensions Index registers: see docs/release.md.
extension-repository: .venv/installed
	$(BIN)/python tools/simulator_wheel.py --repository

page: .venv/installed
	$(BIN)/python tools/page_types.py
	$(BIN)/python tools/build_page.py

lint: .venv/test-installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python tools/page_types.py --check
	$(BIN)/python tools/build_page.py --check
	$(BIN)/python -m mypy --no-error-summary
	$(BIN)/reuse lint --lines

format: .venv/test-installed
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/python tools/reference_pages.py

# The documentation as a website, in build/docs; warnings are errors.
docs: .venv/docs-installed
	$(BIN)/python -m mkdocs build --strict --quiet
	@echo "The documentation is in build/docs: open build/docs/index.html."

# Hashes, but no addresses: the locks hold at whatever index a site uses.
lock: .venv/installed
	$(BIN)/pip install -q uv==0.13.9
	$(COMPILE) --extra page --extra slicer -o requirements/base.lock
	$(COMPILE) --extra test --constraints requirements/base.lock -o requirements/test.lock
	$(COMPILE) --extra bench --constraints requirements/test.lock -o requirements/bench.lock
	$(COMPILE) --extra soak --constraints requirements/test.lock -o requirements/soak.lock
	$(subst pyproject.toml,requirements/ralph.in,$(COMPILE)) -o requirements/ralph.lock
	$(subst pyproject.toml,requirements/icp.in,$(COMPILE)) -o requirements/icp.lock
	$(COMPILE) --extra supply --constraints requirements/base.lock -o requirements/supply.lock
	$(COMPILE) --extra docs --constraints requirements/test.lock -o requirements/docs.lock
	$(COMPILE) --constraints requirements/base.lock --excludes tools/simulator-leaves-out.txt -o $(SIMULATOR)/requirements.lock
	$(BIN)/python tools/measure_simulator.py

# Notices and bills of materials of all that is installed go to build; the audits ask services in the
# internet, and fail where these do not know every package.
LOCK := requirements/base.lock
LICENSES := --from=mixed --with-urls --with-license-file --with-notice-file --no-license-path
audit: .venv/supply-installed
	mkdir -p build
	$(BIN)/pip-licenses --packages $$(sed -n 's/==.*//p' $(LOCK)) $(LICENSES) --format=plain-vertical --output-file=build/third-party-notices.txt
	$(BIN)/cyclonedx-py requirements $(LOCK) --pyproject pyproject.toml --output-reproducible --output-file build/rastrainer.cdx.json
	$(BIN)/python tools/build_page.py npm sbom --package-lock-only --omit=dev --sbom-format=cyclonedx > build/rastrainer-page.cdx.json
	for lock in requirements/*.lock; do $(BIN)/pip-audit --strict --require-hashes --disable-pip -r $$lock || exit 1; done
	$(BIN)/python tools/build_page.py npm audit --package-lock-only

SIMULATOR := RASTrainer/Resources/RASTrainerSimulator
COMPILE := $(BIN)/uv pip compile pyproject.toml --quiet --universal --python-version 3.10 \
	--generate-hashes --no-emit-index-url --no-annotate --no-header --upgrade

$(VENV_PYTHON):
	$(PYTHON) -m venv .venv || (echo "RASTrainer needs Python 3.10 or newer with the venv module (Debian: python3-venv)." >&2; exit 1)

.venv/installed: $(VENV_PYTHON) requirements/base.lock pyproject.toml
	$(BIN)/python -m pip install -q --no-compile --require-hashes -r requirements/base.lock
	$(BIN)/python -m pip install -q --no-deps --no-build-isolation -e .
	touch $@

.venv/test-installed: .venv/installed requirements/test.lock
	$(BIN)/python -m pip install -q --no-compile --require-hashes -r requirements/test.lock
	touch $@

.venv/bench-installed: .venv/test-installed requirements/bench.lock
	$(BIN)/python -m pip install -q --require-hashes -r requirements/bench.lock
	touch $@

# A peer has an environment of its own: it wants other versions of the same packages.
.venv/soak-installed: .venv/test-installed requirements/soak.lock requirements/ralph.lock requirements/icp.lock
	$(BIN)/python -m pip install -q --require-hashes -r requirements/soak.lock
	$(BIN)/python -m venv .venv/ralph
	.venv/ralph/bin/python -m pip install -q --require-hashes -r requirements/ralph.lock
	$(BIN)/python -m venv .venv/icp
	.venv/icp/bin/python -m pip install -q --require-hashes -r requirements/icp.lock
	touch $@

.venv/supply-installed: .venv/installed requirements/supply.lock
	$(BIN)/python -m pip install -q --require-hashes -r requirements/supply.lock
	touch $@

.venv/docs-installed: .venv/installed requirements/docs.lock
	$(BIN)/python -m pip install -q --require-hashes -r requirements/docs.lock
	touch $@

clean:
	rm -rf build .venv
