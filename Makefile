# The everyday commands. Each of them makes what it needs first.
.PHONY: setup demo test results lint format clean

restshape := .venv/bin/restshape
kernels := $(shell find lib/kernels apps/*/kernels -name '*.?pp')
plate := apps/solid/scenes/plate.toml
plate_edits := apps/solid/edits/plate.jsonl
cantilever := apps/cantilever/scenes/cantilever.toml
bridge := apps/bridge/scenes/bridge.toml
building := apps/vibration/scenes/building.toml
fish := apps/metallophone/scenes/fish.toml
bar := apps/metallophone/scenes/bar_200.toml
canvas := apps/couture/scenes/strip.toml
couture := apps/couture
furniture_table := apps/furniture/scenes/table.toml
cantilever_edits := apps/cantilever/edits/cantilever.jsonl

# Two cores hold two ranks or two test workers, one thread each; the rest lets mpiexec start as root, in a
# container, with more ranks than cores, and without a word about network cards that are not there.
export OMP_NUM_THREADS := 1
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_rmaps_base_oversubscribe := 1
export OMPI_MCA_btl := ^openib
export OMPI_MCA_btl_vader_single_copy_mechanism := none
export OMPI_MCA_mca_base_component_show_load_errors := 0

setup:
	@scripts/setup.sh test

demo: setup
	@mkdir -p demo
	$(restshape) replay $(plate) --edits $(plate_edits) --out demo/plate.vtkhdf
	$(restshape) report demo/plate.vtkhdf

test: setup
	.venv/bin/python -m pytest -n 2 --dist worksteal $(PYTEST_ARGS)

# What is committed under results/, rebuilt.
results: setup
	$(restshape) replay $(plate) --edits $(plate_edits) --out results/plate.vtkhdf
	$(restshape) report results/plate.vtkhdf --animation none
	$(restshape) tables
	$(restshape) bench reuse $(plate) $(cantilever) --out results --json results/bench-reuse.json
	$(restshape) bench size --out results --json results/bench-size.json
	$(restshape) bench order $(plate) --json results/bench-order.json
	$(restshape) replay $(cantilever) --edits $(cantilever_edits) --out results/cantilever.vtkhdf
	$(restshape) report results/cantilever.vtkhdf --animation none
	$(restshape) replay apps/thermal/scenes/pipe.toml --out results/pipe.vtkhdf
	$(restshape) report results/pipe.vtkhdf --animation none
	.venv/bin/python -m restshape_verification.bridge.study --picture results/bridge-study.png
	$(restshape) bench predict $(cantilever) --out results --json results/bench-predict.json
	$(restshape) bench derivative $(cantilever) --out results --json results/bench-derivative.json
	.venv/bin/python -m restshape_verification.vibration.resonance --picture results/vibration-resonance.png
	.venv/bin/python -m restshape_apps.metallophone.picture $(fish) --out results/metallophone-modes.png \
		--rasp results/metallophone-rasp.png
	.venv/bin/python -m restshape_apps.metallophone.sound $(fish) --out results/metallophone-fish.wav --seconds 1
	.venv/bin/python -m restshape_verification.metallophone.accuracy --picture results/metallophone-accuracy.png
	$(restshape) replay $(couture)/scenes/sphere.toml --edits $(couture)/edits/sphere-drag.jsonl --out results/couture.vtkhdf
	$(restshape) report results/couture.vtkhdf --animation none
	.venv/bin/python -m restshape_apps.couture.picture results/couture.vtkhdf --frames 0 24 61 \
		--out results/couture-sphere.png
	$(restshape) replay $(couture)/scenes/pins.toml --edits $(couture)/edits/pins.jsonl --out results/couture-pins.vtkhdf
	.venv/bin/python -m restshape_apps.couture.picture results/couture-pins.vtkhdf --frames 0 17 26 \
		--out results/couture-pins.png
	.venv/bin/python tests/physics/bending_kinds.py --picture results/couture-bending.png
	$(restshape) bench drape $(couture)/scenes/sphere.toml --set effects.cloth.bending=hinge --frames 20 \
		--picture results/bench-drape.png
	.venv/bin/python -m restshape_verification.couture.cycles --picture results/couture-cycles.png
	.venv/bin/python -m restshape_apps.solid.picture apps/solid/scenes/column.toml --out results/column-modes.png
	$(restshape) bench eigen $(bar) --set effects.modal.modes=5 --json results/bench-eigen.json
	$(restshape) accuracy $(plate) $(cantilever) $(bridge) $(building) $(fish) $(canvas) $(furniture_table) \
		--out results/accuracy \
		--json results/accuracy/accuracy.json
	$(restshape) stability --json results/stability.json
	$(restshape) stability --fuzz 1000 --json results/fuzz.json

lint:
	@scripts/setup.sh develop
	.venv/bin/python -m ruff check
	.venv/bin/python -m ruff format --check
	.venv/bin/clang-format --dry-run -Werror $(kernels)
	.venv/bin/python -m mypy
	.venv/bin/python -m pytest tests/test_layers.py tests/test_house.py

format:
	@scripts/setup.sh develop
	.venv/bin/python -m ruff check --fix
	.venv/bin/python -m ruff format
	.venv/bin/clang-format -i $(kernels)

clean: # keeps .venv
	rm -rf build .pytest_cache .ruff_cache .mypy_cache .hypothesis lib/restshape/_kernels.*.so apps/*/_kernels.*.so results/*.vtkhdf demo
	find lib apps studies verification tests -name __pycache__ -type d -exec rm -rf {} +
