# make demo: the whole job on a simulated object.  make test: Python and C tests in minutes.
# make test-rest: what takes longer, and what needs a machine that does nothing else.
# make test-long: the further cases and whole studies; test-all: every test.
# make check: format, lint, types, C tests under sanitizers with every compiler found.
PYTHON ?= python3
BIN := .venv/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
STAMP := .venv/installed
ZIG := build/zig/ziglang/zig
SANITIZE := -fsanitize=address,undefined -fno-sanitize-recover=all
C_TESTS := $(wildcard tests/c/test_*.c)
COMPILERS := $(foreach c,gcc clang,$(if $(shell command -v $(c)),$(c)))

include runtime_c/flags.mk

# Tests start thousands of Python processes: each would compile all of springpot again.
unexport PYTHONDONTWRITEBYTECODE

MCU_PACKAGES := gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm gcc-riscv64-unknown-elf \
  picolibc-riscv64-unknown-elf qemu-system-misc \
  clang lld nodejs

.PHONY: demo test test-rest test-long test-all durations test-mcu test-windows setup-mcu firmware soak bench-tick prove docs notebook dist lock licences check format lint types ns test-c clean

# No bytecode yet: Python writes that of what it imports, a third of what pip would compile.
$(STAMP): requirements.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile --require-hashes -r requirements.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

demo: $(STAMP)
	$(BIN)/springpot demo --out demo

test: $(STAMP) test-c
	$(BIN)/pytest -m "not slow and not long and not realtime and not board"

# What `make test` has no time for, and what it skipped for want of a tool (SPRINGPOT_SKIPPED, a list
# that it writes); what runs against the clock has the machine for itself.
test-rest: $(STAMP) $(ZIG)
	$(BIN)/pytest -m "slow and not long and not realtime"
	$(BIN)/pytest -n 0 -m realtime

# A compiler for every system; outside .venv, where it would be that of springpot[cc].
$(ZIG): | $(STAMP)
	$(BIN)/pip install --quiet --disable-pip-version-check --target build/zig ziglang

# What takes above a minute each: before a release, and where its part was changed.
test-long: $(STAMP)
	$(BIN)/pytest -m "long and not realtime"

# Every test once, those on emulated boards if the tools are there.
test-all: test test-rest test-long

# What takes longest, to be marked slow, long or few; M="not slow and not realtime" of `make test`.
M ?= not realtime
durations: $(STAMP)
	$(BIN)/pytest --durations=100 -m "$(M)"

# Cross compilers, emulators and node, from the system's packages, as root.
setup-mcu:
	apt-get update -q >/dev/null
	DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $(MCU_PACKAGES) >/dev/null

# The same C on emulated boards; what is missing here is skipped, counted, and said.
test-mcu: $(STAMP)
	$(BIN)/pytest -n 2 -m board

# A Windows Python under wine (Debian's wine64 and mingw, as root), and the whole job: nine minutes.
test-windows: $(STAMP) $(ZIG)
	tests/windows/make_python.sh build/windows . $(BIN)/python
	tests/windows/smoke.sh build/windows $(BIN)/python

# make firmware BOARD=mps2-an386 SCENE=scene.toml: build/firmware/BOARD/firmware.elf and its sources.
firmware: $(STAMP)
	$(BIN)/springpot firmware --scene $(SCENE) --board $(BOARD) --out build/firmware/$(BOARD)

# Frama-C's Eva over the emitted C, the protocol and the links; then planted defects, each of which it
# must see. Needs frama-c-base.
prove: $(STAMP) ns
	PYTHONPATH=build/ns $(BIN)/python tests/proof/prove.py --defects $(if $(JSON),--out $(JSON))

# Source archive and wheel of the commit in dist/: built twice, the same bytes.
dist: $(STAMP)
	$(BIN)/python .ci/dist.py dist

# requirements.lock: every version and hash that the targets here install, for every system.
lock: $(STAMP)
	$(BIN)/pip install --quiet --disable-pip-version-check uv
	echo setuptools | $(BIN)/uv pip compile --quiet --universal --python-version 3.11 \
	  $(foreach extra,train report can m2cgen scale study docs,--extra $(extra)) --group dev \
	  --generate-hashes --no-header --no-annotate -o requirements.lock pyproject.toml -

# Licences of everything that is installed here; .ci/packages refuses copyleft in what is required.
licences: $(STAMP)
	$(BIN)/pip-licenses --from=mixed --order=license

# Long tests: all 2^32 bit patterns through the guards, 1e8 hostile ticks a scene, 24 simulated hours
# of pressing, every object and model in closed loop; a million damaged frames, every fault of a
# session five times; scenes, tables and the wire, an hour each under a fuzzer.
soak: $(STAMP) test-c
	$(C_BUILD)/$(firstword $(COMPILERS))/float/test_patterns 1
	SPRINGPOT_SOAK=1 $(BIN)/pytest tests/host/stability/test_hostile.py tests/host/stability/test_stability.py tests/codegen/stages/test_engines.py
	SPRINGPOT_FRAMES=1000000 $(BIN)/pytest tests/host/devices/test_wire.py
	SPRINGPOT_ROUNDS=5 $(BIN)/pytest -n0 tests/host/session/test_faults.py
	$(BIN)/pip install --quiet --disable-pip-version-check atheris
	for target in scene text wire; do $(BIN)/python tests/proof/fuzz/fuzz.py $$target -timeout=10 \
	  -max_total_time=3600 -rss_limit_mb=1024 -max_len=1048576 -artifact_prefix=build/fuzz/ || exit 1; done

# The documentation, build/docs/html/index.html: a broken link or anchor is an error.
docs: $(STAMP) ns
	PYTHONPATH=build/ns:docs/_ext $(BIN)/python -m reference_pages
	PYTHONPATH=build/ns $(BIN)/sphinx-build -W -n --keep-going -q -E -d build/docs/doctrees docs build/docs/html
	@echo build/docs/html/index.html

# Run examples/quick_start.ipynb and store what it shows.
notebook: $(STAMP)
	cd tests && ../$(BIN)/python -m support.pages.notebooks

# Whole ticks beside plain taps and m2cgen, the forest alone by others; JSON=FILE for the figures.
bench-tick: $(STAMP)
	$(BIN)/pip install --quiet --disable-pip-version-check tl2cgen treelite onnxruntime skl2onnx
	$(BIN)/python tests/bench/ticks/tick.py $(if $(JSON),--json $(JSON))

check: format lint types
	$(MAKE) test-c C_EXTRA="$(SANITIZE)" C_BUILD=build/c-sanitized

format: $(STAMP)
	$(BIN)/ruff format --check --quiet .
	$(BIN)/clang-format --dry-run --Werror $$(git ls-files 'runtime_c/*.[ch]' 'tests/c/*.[ch]' 'tests/proof/fuzz/*.[ch]')

lint: $(STAMP)
	$(BIN)/ruff check --quiet .

types: $(STAMP) ns
	$(BIN)/mypy --platform linux
	for system in win32 darwin; do $(BIN)/mypy --platform $$system --no-warn-unreachable || exit 1; done
	MYPYPATH=docs/_ext:build/ns $(BIN)/mypy docs/_ext

# mypy and pyright find springpot by a folder of that name.
ns:
	@mkdir -p build/ns && ln -sfn ../.. build/ns/springpot

# Each program of tests/c by every compiler, with sp_real float and double: built once, all cores.
C_BUILD ?= build/c
C_EXTRA ?=
C_SOURCES := $(wildcard tests/c/*.[ch] runtime_c/*/*.[ch] runtime_c/*/*/*.[ch]) runtime_c/flags.mk
C_PROGRAMS := $(foreach cc,$(COMPILERS),$(foreach real,float double,\
  $(patsubst tests/c/%.c,$(C_BUILD)/$(cc)/$(real)/%,$(C_TESTS))))
test-c:
	@test -n "$(COMPILERS)" || { echo "no C compiler: install gcc or clang"; exit 1; }
	@$(MAKE) --no-print-directory -j$$(nproc) $(C_PROGRAMS)
	@set -e; for program in $(C_PROGRAMS); do $$program; done
	@echo "C tests: $(words $(C_TESTS)) programs x float, double x $(COMPILERS) $(C_EXTRA)"

$(C_PROGRAMS): $(C_BUILD)/%: $(C_SOURCES)
	@mkdir -p $(@D)
	@$(firstword $(subst /, ,$*)) $(SP_CFLAGS) $(SP_STRICT) $(C_EXTRA) -D_POSIX_C_SOURCE=200809L \
	  -Iruntime_c/include/$(word 2,$(subst /, ,$*)) -Iruntime_c/include -Iruntime_c/src \
	  -Iruntime_c/sim -Itests/c tests/c/$(@F).c -o $@ -lm

clean:
	rm -rf build .venv demo
