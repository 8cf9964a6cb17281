# make demo: train briefly, export, read a photograph.  make test: everything that must pass.
PYTHON ?= $(or $(shell command -v python3.11),python3)
BIN := .venv/bin
READY := .venv/.ready

# Compiled modules are kept: tests start many processes, and each would compile the package again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test blender coverage fuzz test-fast test-lowest lint format bench docs runtime wheel audit clean

demo: $(READY)
	$(BIN)/python -m train fit --config configs/quick.yaml
	$(BIN)/python -m export runs/quick/best.ckpt -o runs/quick/skin.onnx
	$(BIN)/python -m examples.astronaut

# A worker starts with half of the files in their order, so that few files share their fixtures with
# the other; who ends first takes over.
test: $(READY) runtime
	$(BIN)/python -m pytest -n 2 --dist worksteal

# The lines that no test runs; tracing takes twice the time of the tests.
coverage: $(READY) runtime
	$(BIN)/python -m pytest -n 2 --cov --cov-report=term:skip-covered

# An hour of damaged and hostile inputs; each fault is printed with the command that shows it again.
MINUTES ?= 60
fuzz: $(READY)
	$(BIN)/python -m benchmarks.faults --minutes $(MINUTES) --seed $(or $(SEED),$(shell date +%s))

test-fast: $(READY) runtime
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow"

# In an environment of its own, with the lowest versions that pyproject.toml allows.
test-lowest:
	$(PYTHON) -m venv .venv-lowest
	$(PYTHON) tools/lowest.py > .venv-lowest/constraints.txt
	.venv-lowest/bin/python -m pip install --quiet -c .venv-lowest/constraints.txt -e ".[dev]"
	.venv-lowest/bin/python -m pytest -n 2

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(READY)
	$(BIN)/python -m benchmarks.spectra
	$(BIN)/python -m benchmarks.edits
	$(BIN)/python -m benchmarks.decoder
	$(BIN)/python -m benchmarks.latency
	$(BIN)/python -m benchmarks.quantised
	$(BIN)/python -m benchmarks.fit
	$(BIN)/python -m benchmarks.texture
	$(BIN)/python -m benchmarks.lookup
	$(BIN)/python -m benchmarks.calibration
	$(BIN)/python -m benchmarks.appearance
	$(BIN)/python -m benchmarks.faces
	$(BIN)/python -m benchmarks.full_resolution
	$(BIN)/python -m benchmarks.encoder
	$(BIN)/python -m benchmarks.constancy
	$(BIN)/python -m benchmarks.identifiability
	$(BIN)/python -m benchmarks.charts
	$(BIN)/python -m benchmarks.indices
	$(BIN)/python -m benchmarks.shaders

# The guide, as pages that open without a server: build/site/index.html.
docs: $(READY)
	NO_MKDOCS_2_WARNING=1 PYTHONPATH=. $(BIN)/python -m mkdocs build --strict --quiet

# What the web page needs from npm; without npm a sentence says so, and the page is left out.
runtime: $(READY)
	@$(BIN)/python -m tools.web_runtime || true

# Blender as a Python module, for tests of the shader alone; 374 MB from the package index.
blender: .venv-blender/.ready

.venv-blender/.ready:
	$(PYTHON) -m venv .venv-blender
	.venv-blender/bin/python -m pip install --quiet bpy==5.0.1
	touch .venv-blender/.ready

# The bill of materials lies beside the wheel, and in its folder .dist-info/sboms.
wheel: $(READY) runtime
	rm -rf build/bill
	$(BIN)/python -m tools.bill_of_materials build/bill
	$(BIN)/python -m build --wheel
	cp build/bill/*.cdx.json dist

# Known vulnerabilities of the tested versions; skipped in a sentence where no database answers.
audit: $(READY)
	$(BIN)/python -m tools.audit

clean:
	rm -rf .venv .venv-lowest .venv-blender build dist

# The constraints hold the tested versions; without them a package that needs torch may bring CUDA.
$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet -c constraints.txt -e ".[dev]"
	touch $(READY)
