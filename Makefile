# `make study` and `make test` set up .venv when it is missing or out of date, then run.

PYTHON ?= python3
JOBS ?= 2
BIN := .venv/bin
ALL_CORES := -n auto --no-loadscope-reorder
PIP_INSTALL := $(BIN)/python -m pip install --no-compile --disable-pip-version-check -c constraints.txt
STAMP := .venv/installed-$(shell cat pyproject.toml constraints.txt | cksum | cut -d ' ' -f 1)
# after `pip install .` the environment has a copy of the package, or what pip left of one: Python
# would import it in place of the sources here
COPY := .venv/lib/python*/site-packages/bearingwear

# each of a study's processes would do anew what Python makes of a hundred sources
unexport PYTHONDONTWRITEBYTECODE

.PHONY: study test quick docs gallery test-long test-slurm test-faults test-page fuzz always accuracy-docs effects-docs cages-docs bench venv clean

study: $(STAMP)
	$(BIN)/snakemake -j$(JOBS)

test: $(STAMP) # on all cores; the solver is compiled while the text is checked
	trap 'kill $$compiling 2> /dev/null' EXIT INT TERM; \
	$(BIN)/python tests/compile_solver.py unworn & compiling=$$!; \
	$(BIN)/ruff check . && \
	$(BIN)/ruff format --check . && \
	$(BIN)/snakefmt --check Snakefile workflow && \
	$(BIN)/codespell && \
	$(BIN)/mypy && \
	$(BIN)/python tests/compile_solver.py worn && \
	$(BIN)/python -m pytest $(ALL_CORES)

quick: $(STAMP) # half a minute: what solves little and starts no other programs
	$(BIN)/python -m pytest $(ALL_CORES) tests/kernels tests/scene tests/plotting tests/test_names.py \
		tests/test_provenance.py --ignore tests/kernels/test_kernel_cache.py

test-long: $(STAMP) # slow tests, as of whole studies: not part of `make test`
	# cf: only its own test needs it, which is skipped where it cannot be installed
	-$(PIP_INSTALL) -q -e '.[cf]'
	$(BIN)/python -m pytest $(ALL_CORES) -m long

test-slurm: $(STAMP) # starts a Slurm of one node, as root, with slurm-wlm and munge installed; and a submit command
	$(BIN)/python -m pip install --disable-pip-version-check -c constraints.txt -e '.[slurm]'
	$(BIN)/python -m pytest -rs -m cluster

# the page in headless Chromium (Debian: apt install chromium npm): a small study's and those that are there
AXE := build/axe/node_modules/axe-core/axe.min.js
test-page: $(STAMP) $(AXE)
	$(BIN)/python -m pip install --disable-pip-version-check -c constraints.txt -e '.[page]'
	BEARINGWEAR_PAGES="$(wildcard results/report/index.html */index.html)" $(BIN)/python -m pytest -rs tests/page

$(AXE): # what tests accessibility, of the version that the page is known to pass
	npm install --silent --no-save --prefix build/axe axe-core@4.14.1

test-faults: $(STAMP) # kills, full disks, damaged files, clocks: minutes, not part of `make test`
	$(BIN)/python -m pytest -m faults

# 122 000 steady and race-control solves, pairs among them, and 490 short dynamic runs of random scenes, half an hour;
# exit 3 if one is wrong.
# A few that are drawn in time are no bearing, hence 306.
FUZZ := steady:25000 steady_stress:35000 race_control:20000 race_control_stress:20000 dynamic:153 dynamic_stress:153 \
	steady_warm:2000 race_control_warm:2000 dynamic_warm:40 steady_pair:1500 race_control_pair:1500 \
	steady_hertz:10000 race_control_hertz:5000 dynamic_hertz:153
FUZZ_FILES := $(foreach f,$(FUZZ),results/fuzz/$(firstword $(subst :, ,$(f))).nc)
SEED ?= 2
fuzz: $(STAMP)
	$(MAKE) -j$(JOBS) $(FUZZ_FILES)
	$(STEP).gather.counted_ends paths= $(FUZZ_FILES) -o results/fuzz/fuzz.nc
	$(STEP).tables.ends_table counts=results/fuzz/fuzz.nc -o results/fuzz/fuzz.md
	$(STEP).tables.wrong_answers counts=results/fuzz/fuzz.nc -o results/fuzz/verdict.txt

STEP := $(BIN)/bearingwear step workflow.studies.robustness
FUZZ_COUNT = $(patsubst $*:%,%,$(filter $*:%,$(FUZZ)))
results/fuzz/%.nc: always
	$(STEP).run.random_scenes plan=config/robustness.yaml name=$* count=$(FUZZ_COUNT) seed=$(SEED) -o $@

ACCURACY_INTO := $(BIN)/bearingwear step workflow.studies.accuracy
ACCURACY_DOCS := $(ACCURACY_INTO).docs.docs_with_part plan=config/accuracy.yaml docs=docs/accuracy.md
ACCURACY_GIVEN := trade=results/accuracy/accuracy.nc
accuracy-docs: $(STAMP) # after `snakemake -j2 accuracy`: its numbers into docs/accuracy.md, and a figure
	$(ACCURACY_DOCS) $(ACCURACY_GIVEN) part=accuracy -o docs/accuracy.md
	$(ACCURACY_INTO).figures.figure $(ACCURACY_GIVEN) which=overview -o docs/figures/tradeoff.png

EFFECTS_GIVEN := trade=results/accuracy/effects.nc
effects-docs: $(STAMP) # single effects and worn grooves alone, solved anew, into docs/accuracy.md and a figure: 3 minutes
	$(BIN)/snakemake -j1 results/accuracy/effects.nc
	$(ACCURACY_DOCS) $(EFFECTS_GIVEN) part=effects -o docs/accuracy.md
	$(ACCURACY_DOCS) $(EFFECTS_GIVEN) part=grooves -o docs/accuracy.md
	$(ACCURACY_INTO).figures.figure $(EFFECTS_GIVEN) which=grooves -o docs/figures/grooves.png

cages-docs: $(STAMP) # ensembles of a cage alone, into docs/accuracy.md: 4 minutes of CPU time
	$(BIN)/snakemake -j$(JOBS) results/accuracy/cages.nc
	$(ACCURACY_DOCS) trade=results/accuracy/cages.nc part=cages -o docs/accuracy.md

docs: $(STAMP) # the site, into build/site; opens from disk, needs no network
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt -e '.[docs]'
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict -q

gallery: $(STAMP) # the figures of docs/gallery, drawn again; minutes
	$(BIN)/python docs/site/gallery.py

bench: $(STAMP) # times against the plain SciPy program
	$(BIN)/python benchmarks/speed.py

venv: $(STAMP)

# named by the contents of pyproject.toml and constraints.txt, so that a touch sets up nothing anew
$(STAMP): $(if $(wildcard $(COPY)),always)
	@echo 'setting up .venv: about half a minute'
	$(PYTHON) -m venv .venv
	$(PIP_INSTALL) -q -e '.[test]' # Python compiles what it imports
	rm -rf $(COPY) .venv/installed-*
	touch $@

clean: # results and logs go, .venv stays
	rm -rf .snakemake logs build ./*.egg-info
	find results -mindepth 1 ! -name README.md -delete
