# The everyday commands. Each of them makes what it needs first.
.PHONY: setup demo test weekly results lint format clean

restshape := .venv/bin/restshape
kernels := $(shell find lib/kernels apps/*/kernels -name '*.?pp')
plate := apps/solid/scenes/plate.toml
plate_edits := apps/solid/edits/plate.jsonl

# Two cores hold two ranks or two test workers, one thread each; the rest lets mpiexec start as root, in a
# container, with more ranks than cores, and without a word about network cards that are not there. The
# transports left out are those that Debian leaves out too: with one of them each process ends a second later.
export OMP_NUM_THREADS := 1
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_rmaps_base_oversubscribe := 1
export OMPI_MCA_btl := ^uct,openib,ofi
export OMPI_MCA_btl_vader_single_copy_mechanism := none
export OMPI_MCA_mca_base_component_show_load_errors := 0

setup:
	@scripts/setup.sh test

demo: setup
	@mkdir -p demo
	$(restshape) replay $(plate) $(plate_edits) --out demo/plate.vtkhdf
	$(restshape) report demo/plate.vtkhdf
	@echo "to hold the shape yourself, in a browser: .venv/bin/restshape live $(plate) --open"
	@echo "next, to have the command restshape in this shell: . .venv/bin/activate"

test: setup
	.venv/bin/python -m pytest -n 2 --dist worksteal $(PYTEST_ARGS)

# What takes too long for every day: tests with that mark; shipped scripts, each on the mesh of its scene; planted
# faults, each of which its test must notice; writes results/mutants.md.
weekly: setup
	.venv/bin/python -m pytest -n 2 --dist worksteal -m "weekly and not results" $(PYTEST_ARGS)
	.venv/bin/python tests/shipped_scripts.py
	.venv/bin/python scripts/mutants.py

# What is committed under results/, as far as it is of older code: docs/results.md.
results: setup
	.venv/bin/python scripts/results.py

lint:
	@scripts/setup.sh develop
	.venv/bin/python -m ruff check
	.venv/bin/python -m ruff format --check
	.venv/bin/clang-format --dry-run -Werror $(kernels)
	.venv/bin/python -m mypy
	npm run --silent check
	.venv/bin/python -m pytest tests/test_layers.py tests/test_house.py tests/test_words.py

format:
	@scripts/setup.sh develop
	.venv/bin/python -m ruff check --fix
	.venv/bin/python -m ruff format
	.venv/bin/clang-format -i $(kernels)

clean: # keeps .venv
	rm -rf node_modules lib/restshape/live/page/dist build .pytest_cache .ruff_cache .mypy_cache .hypothesis lib/restshape/_kernels.*.so apps/*/_kernels.*.so results/*.vtkhdf demo
	find lib apps studies verification tests -name __pycache__ -type d -exec rm -rf {} +
