# The commands of a checkout. `make test` is what CI runs.

PYTHON ?= $(or $(shell command -v python3.11),python3)
VENV := .venv
BIN := $(VENV)/bin

# Two pytest workers on two cores: more threads in each would only fight over them. Stealing leaves
# neighbours together, so that what a file's tests share is made once.
WORKERS ?= 2
PYTEST := OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 $(BIN)/pytest -n $(WORKERS) --dist worksteal

# A change of either file installs anew; a second run does not.
REQUIREMENTS := pyproject.toml constraints.txt
RUNTIME_STAMP := $(VENV)/.runtime-installed
DEV_STAMP := $(VENV)/.dev-installed

.DEFAULT_GOAL := help
# Two recipes at once would fight over apt's lock and the venv.
.NOTPARALLEL:
.PHONY: help install demo test soak docs lint contracts types wheel-test format clean gl browser

help: ## print this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

install: $(DEV_STAMP) gl browser ## make .venv with everything that a developer needs

demo: $(RUNTIME_STAMP) gl ## teach a policy to drive and watch it in the browser; PORT=0 takes any
	@hold=; if [ -t 1 ]; then hold=--hold; echo 'The page stays open at the end, until Ctrl-C.'; fi; \
	$(BIN)/sheath experiment driving --quick --dashboard $(if $(PORT),--port $(PORT)) $$hold

# Fast to slow; the first that fails stops the rest.
test: $(DEV_STAMP) gl browser ## lint, import contracts, types, documentation, tests
	@$(MAKE) -j 2 lint contracts types docs
	$(PYTEST)

soak: $(DEV_STAMP) gl browser ## what takes an hour: many cases, long runs, kills
	$(PYTEST) -m 'soak or hypothesis' --hypothesis-profile soak --timeout 900
	$(BIN)/python -m tools.soak --minutes 3
	$(BIN)/python -m tools.kill_recorder --kills 30 --writers 2 --polls 1000
	$(BIN)/python -m tools.kill_runs --kills 25 --results build

lint: $(DEV_STAMP) ## ruff: rules and format
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

contracts: $(DEV_STAMP) ## the direction of the imports
	@rm -rf build/contracts && mkdir -p build/contracts
	@cp -rL sheath_manip pyproject.toml build/contracts/
	cd build/contracts && PYTHONPATH=. $(CURDIR)/$(BIN)/lint-imports

types: $(DEV_STAMP) ## pyright
	$(BIN)/pyright

docs: $(DEV_STAMP) ## build the documentation's site, strictly: build/docs/index.html
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going -j 2 docs build/docs

wheel-test: $(DEV_STAMP) gl ## install the wheel in a venv of its own and try it; the tests do it too
	$(TEST_ENVIRONMENT) $(BIN)/pytest -n 0 tests/wheel

format: $(DEV_STAMP) ## let ruff fix and format the code
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean: ## remove .venv and all caches; results/ and runs/ stay
	rm -rf $(VENV) build *.egg-info .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

gl browser:
	@tools/system_packages.sh $@

$(BIN)/python:
	@PYTHON=$(PYTHON) tools/system_packages.sh venv
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null
	$(PYTHON) -m venv $(VENV)

$(RUNTIME_STAMP): $(REQUIREMENTS) | $(BIN)/python
	@echo 'Installing into $(VENV): a minute or two, or more where torch comes from afar'
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[tasks]'
	@touch $@

# The development set holds the runtime set.
$(DEV_STAMP): $(REQUIREMENTS) | $(BIN)/python
	@echo 'Installing into $(VENV): a minute or two, or more where torch comes from afar'
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[dev]'
	@touch $@ $(RUNTIME_STAMP)
