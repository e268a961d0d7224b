# `make demo`: the paper's two baselines at graph level and in MuJoCo, with a report and a film.
# `make quick`: the tests that take about a minute on two free cores, when kernels are compiled.
# `make test`: ruff, mypy, import-linter, and all tests but those of `make thorough`: ten minutes.
# `make thorough`: tests of whole runs: commands, killed runs, trainings, vessels, reports, films, blocks of pages.
# `make capabilities`: tests of learning, under each lesser set of instructions of this processor.
# `make mujoco`: vessels, items and scenarios with MuJoCo 4, and a comparison of both versions.
# `make lowest`: core, physics, runs and commands with the lowest versions that pyproject.toml allows.
# `make dist`: a wheel and an sdist in dist/, checked, installed elsewhere and used.
# `make docs`: the site, under build/site; open build/site/index.html.
# `make links`: its links to other sites, by Sphinx's linkcheck.
# `make gallery`: the films of docs/gallery.md, by the commands that stand there; a quarter of an hour.
# `make pages`: accessibility of report pages and of the site, in headless Chromium.
# `make evidence`: numbers of the pages made again, hours of them; ONLY="name name" JOBS=2 for some.
# `make evidence-pages`: their tables drawn from docs/evidence/data.
# `make mutants`: single faults of a list, each of which a test has to notice; an hour on two cores.
# `make mutants-some`: the same for every fifteenth of them, others after each commit.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

# Tests start many processes, each of which would compile our modules anew where this is set.
unexport PYTHONDONTWRITEBYTECODE

# What torch computes depends on the processor's instructions, so learning is tested under each set
# that this processor has; `make test` and `make thorough` do so under the largest.
CAPABILITIES := default avx2 avx512
LEARNING = $(shell grep --recursive --files-with-matches --include 'test_*.py' mark.every_capability tests)

.PHONY: demo quick test thorough types collected kernels-graph kernels-physics capabilities mujoco lowest environments mutants mutants-some evidence evidence-pages dist docs links pages gallery install clean
.DEFAULT_GOAL := demo

$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[film]'
	touch $@

$(VENV)/.installed-dev: $(VENV)/.installed
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[dev]'
	touch $@

$(VENV)/.installed-docs: $(VENV)/.installed-dev
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[dev,docs]'
	touch $@

install: $(VENV)/.installed

demo: $(VENV)/.installed
	$(BIN)/mjforage compare comb-port --policy greedy --policy levy --episodes 20 --jobs 2 --out runs/demo
	$(BIN)/mjforage render runs/demo --world physics --policy greedy --duration 600 --fps 15 --width 960 --height 540 -o runs/demo/port.mp4

# `slow` is what stands in tests/slow.txt, and what loads torch (tests/conftest.py).
quick: $(VENV)/.installed-dev
	$(BIN)/pytest -n 2 --dist worksteal -m 'not slow'

# Tests of the site's extensions need what builds it.
test: $(VENV)/.installed-docs
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(MAKE) --jobs 3 kernels-graph types kernels-physics collected
	$(BIN)/pytest -n 2 --dist worksteal -m 'not thorough'

thorough: $(VENV)/.installed-docs
	$(BIN)/pytest -n 2 --dist worksteal -m thorough

types: $(VENV)/.installed-dev
	$(BIN)/mypy

# Each of pytest's processes would rewrite the asserts of all files that have no cached bytecode.
collected: $(VENV)/.installed-docs
	$(BIN)/pytest --collect-only --quiet >/dev/null

# Compile what most tests need, of all policies; for what both worlds need one waits for the other.
kernels-graph: $(VENV)/.installed-dev
	$(BIN)/mjforage compile comb-port-weather --world graph >/dev/null

kernels-physics: $(VENV)/.installed-dev
	$(BIN)/mjforage compile comb-port-weather --world physics >/dev/null

capabilities: $(VENV)/.installed-dev
	most=$$($(BIN)/python -c 'import torch; print(torch.backends.cpu.get_cpu_capability().lower())'); \
	for capability in $(CAPABILITIES); do \
		[ $$capability != $$most ] || break; \
		echo "learning, ATEN_CPU_CAPABILITY=$$capability of at most $$most"; \
		ATEN_CPU_CAPABILITY=$$capability $(BIN)/pytest -n 2 -rs -m every_capability $(LEARNING) || exit 1; \
	done

# The second MuJoCo lies before all other libraries, which both environments share. Version 4 splits
# its package: the core is all that we use.
MUJOCO := 4.0.0

# Kernels and hulls on a device hang on MuJoCo Warp's version.
NOT_OURS := --ignore tests/mjforage/physics/dynamics/test_device_kernels.py \
	--ignore-glob '*/test_warp_*'

$(VENV)/mujoco-$(MUJOCO)/.installed: $(VENV)/.installed-dev
	rm -rf $(@D)
	$(BIN)/python -m venv $(@D)
	$(BIN)/python -c "import sysconfig; print(sysconfig.get_path('purelib'))" \
		>"$$($(@D)/bin/python -c "import sysconfig; print(sysconfig.get_path('purelib'))")/libraries.pth"
	$(@D)/bin/pip install --quiet --no-deps mujoco==$(MUJOCO) mujoco-core==$(MUJOCO)
	touch $@

# Libraries of another environment do not bring numba-cuda's redirection, which no hull needs.
mujoco: $(VENV)/mujoco-$(MUJOCO)/.installed
	PYTHONPATH=$(CURDIR) $(BIN)/python tests/mjforage/physics/simulation/crowd.py \
		--beside $(CURDIR)/$(<D)/bin/python
	PYTHONPATH=$(CURDIR) $(<D)/bin/python -m pytest -n 2 --dist worksteal tests/mjforage/physics $(NOT_OURS)
	rm -rf $(<D)/run
	PYTHONPATH=$(CURDIR) $(<D)/bin/python -m mjforage compare comb-port-weather --policy greedy \
		--out $(<D)/run --episodes 1 --set horizon=20 --replay none >/dev/null

# Their own warnings are not ours: what is deprecated today was not when they were made.
OLD := tests/mjforage/scenario tests/mjforage/mission tests/mjforage/physics/callback tests/mjforage/physics/scene \
	tests/mjforage/physics/simulation tests/mjforage/runs/test_evaluate.py tests/mjforage/runs/test_storage.py \
	tests/mjforage/runs/test_exported_tracks.py tests/mjforage/runs/test_live_stream.py \
	tests/mjforage/runs/test_tables.py tests/mjforage/runs/test_resuming.py tests/mjforage/cli/test_maps.py \
	tests/mjforage/cli/test_run_folders.py tests/mjforage/view/render/test_video.py

$(VENV)/lowest/.installed: lowest.txt constraints.txt pyproject.toml
	rm -rf $(@D)
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/pip install --quiet --requirement lowest.txt
	$(@D)/bin/pip install --quiet --constraint constraints.txt pytest pytest-xdist hypothesis jsonschema
	$(@D)/bin/pip install --quiet 'numpy==2.1.0' 'rosbags==0.10.11'
	$(@D)/bin/pip install --quiet --no-deps --editable .
	$(@D)/bin/pip check
	touch $@

# What `.ci/run` needs, the two large ones at the same time.
environments: $(VENV)/.installed-docs $(VENV)/lowest/.installed $(VENV)/mujoco-$(MUJOCO)/.installed

lowest: $(VENV)/lowest/.installed
	$(<D)/bin/python -m pytest -n 2 --dist worksteal -m 'not slow' -W ignore::DeprecationWarning $(OLD)

mutants: $(VENV)/.installed-dev
	$(BIN)/python -m tests.mutants --jobs 2

mutants-some: $(VENV)/.installed-dev
	$(BIN)/python -m tests.mutants --jobs 2 --some $$(git rev-list --count HEAD 2>/dev/null || echo 0)

# What was stopped goes on; without ONLY what is of this very code already is left out, and the long
# blocks of pages that no piece runs come last.
evidence: $(VENV)/.installed-dev
	$(BIN)/python -m tests.evidence $(ONLY) --jobs $(or $(JOBS),1)
	$(if $(ONLY),,$(BIN)/python -m tests.documents)

evidence-pages: $(VENV)/.installed-dev
	$(BIN)/python -m tests.evidence --pages

# TRY="--python python3.12" installs the declared dependencies too, for that interpreter.
dist: $(VENV)/.installed-dev
	rm -rf dist
	PIP_CONSTRAINT=$(CURDIR)/constraints.txt $(BIN)/python -m build
	$(BIN)/twine check --strict dist/*
	$(BIN)/python -m tests.packaging $(TRY)

SPHINX := $(BIN)/python -m sphinx --nitpicky --quiet --doctree-dir build/doctrees
STRICT := --fail-on-warning --keep-going

# Everything is read anew, so that a page that is gone leaves nothing behind. Notebooks are run, which
# takes two minutes and EGL.
docs: $(VENV)/.installed-docs
	rm -rf build/site
	$(SPHINX) $(STRICT) --fresh-env --builder html docs build/site

links: $(VENV)/.installed-docs
	$(SPHINX) --builder linkcheck docs build/links

# As the page has them; needs EGL, on Debian `libegl1 libegl-mesa0 libgl1-mesa-dri`.
gallery: $(VENV)/.installed-dev
	rm -rf build/gallery
	$(BIN)/python -m tests.documents --keep build/gallery docs/gallery.md
	cp build/gallery/docs-gallery/*.gif docs/gallery/

# Chromium and npm are not Python's: on Debian `chromium` and `npm`.
pages: $(VENV)/.installed-dev docs
	npm install --prefix tests/pages --no-package-lock --no-audit --no-fund
	rm -rf $(VENV)/pages
	$(BIN)/mjforage compare comb-port --policy greedy --policy levy --episodes 2 \
		--set horizon=40 --out $(VENV)/pages/run
	$(BIN)/mjforage study ablation comb-port --policy greedy --policy levy --episodes 2 \
		--set horizon=40 --out $(VENV)/pages/study
	$(BIN)/mjforage evaluate comb-port --policy belief --episodes 2 --set horizon=40 \
		--out $(VENV)/pages/other
	$(BIN)/mjforage report $(VENV)/pages/run $(VENV)/pages/other --out $(VENV)/pages/both
	node tests/pages/check.js $(VENV)/pages/run/report.html $(VENV)/pages/study/report.html \
		$(VENV)/pages/both/report.html
	node tests/pages/site.js build/site

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
