# Each line is a command that a person could type.
PYTHON ?= python3
VENV := .venv
BIN := $(CURDIR)/$(VENV)/bin
TARGETS := thumbv7em-none-eabihf thumbv6m-none-eabi riscv32imc-unknown-none-elf
NO_PANIC := cargo build --locked --manifest-path tests/no_panic/Cargo.toml --target-dir target

OLDEST := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
MODEL_FEATURES := integrator construction sensitivity identification experimental serde defmt

.PHONY: test test-rust test-python clock demo browser mqtt faults long fuzz lint features oldest packages packaging other-systems wheels windows bench validate accuracy pulse-prior embedded firmware node-pico node docs api

# With the example, the command takes the libraries that `make test` has built.
COMMAND := cargo build --locked --features serve --bin dose --example simulated_node --example simulated_klipper

test: test-rust test-python

# Tests wait for boards, balances and kills more than they compute, so three at a time share a core.
test-rust:
	RUST_TEST_THREADS=$${RUST_TEST_THREADS:-$$((3 * $$(getconf _NPROCESSORS_ONLN)))} cargo test --locked --features serve

test-python: $(VENV)/installed
	$(COMMAND)
	cd crates/pump-py && $(BIN)/python -m pytest -q -n auto --dist loadfile

# Installed anew whenever a source of the Python module has changed.
$(VENV)/installed: $(shell git ls-files -- Cargo.lock Cargo.toml ':(glob)crates/*/src/**' ':(glob)crates/*/Cargo.toml' crates/pump-py/pyproject.toml crates/pump-py/python)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet "./crates/pump-py[test]"
	touch $@

# The command by a clock that libfaketime turns, and the units of systemd by its own check; `make test` leaves out what
# the machine lacks.
clock:
	command -v faketime || (apt-get update && apt-get install -y --no-install-recommends faketime)
	command -v systemd-analyze || (apt-get update && apt-get install -y --no-install-recommends systemd)
	FAKETIME_NEEDED=1 SYSTEMD_NEEDED=1 cargo test --locked --features serve --test command -- unattended::clock unattended::units

# The demo: one page with the planner and the model inside, target/demo/index.html. Node.js holds the module to the bits
# that this machine computes. `make browser` opens it in Chromium.
DEMO := --locked --manifest-path demo/Cargo.toml --target-dir target
demo:
	rustup target add wasm32-unknown-unknown
	command -v node || (apt-get update && apt-get install -y --no-install-recommends nodejs)
	cargo build $(DEMO) --release --target wasm32-unknown-unknown
	$(PYTHON) demo/build.py target/wasm32-unknown-unknown/release/pump_demo.wasm target/demo/index.html
	cargo test $(DEMO)
	cargo clippy $(DEMO) --all-targets -- -D warnings
	cargo clippy $(DEMO) --release --target wasm32-unknown-unknown -- -D warnings
	cargo run $(DEMO) --example reference >target/demo/reference.json
	node demo/check.mjs target/demo/index.html target/demo/reference.json

# The page of `dose serve` in Chromium: what people do, over bad networks and kills too, for barriers with axe, and its
# times. Two idle cores take less than 5 minutes. `PAGE=crates/pump-service/src/page` at pytest tries a page before a build.
# npm keeps what it fetches within the checkout.
BROWSER := .venv-browser
browser: demo $(BROWSER)/installed
	command -v chromium || (apt-get update && apt-get install -y --no-install-recommends chromium fonts-liberation)
	command -v npm || (apt-get update && apt-get install -y --no-install-recommends nodejs npm)
	cd tests/browser && npm ci --no-audit --no-fund --cache ../../target/npm
	$(COMMAND)
	timeout 480 $(BROWSER)/bin/python -m pytest -q --durations=3 tests/browser

$(BROWSER)/installed: tests/browser/requirements.txt
	$(PYTHON) -m venv $(BROWSER)
	$(BROWSER)/bin/pip install --quiet -r $<
	touch $@

# The service at a real MQTT broker, and behind a real proxy with TLS; `make test` leaves these tests out where there is
# none.
mqtt:
	command -v mosquitto || test -x /usr/sbin/mosquitto || (apt-get update && apt-get install -y --no-install-recommends mosquitto)
	command -v nginx || test -x /usr/sbin/nginx || (apt-get update && apt-get install -y --no-install-recommends nginx-light)
	MQTT_NEEDED=1 PROXY_NEEDED=1 cargo test --locked --features serve --test serve -- mqtt proxy

# Doses cut off at random instants, and the books of random operations; `make test` runs fewer of both.
faults: clock
	FAULTS_RUNS=500 cargo test --locked --test faults
	SERVE_KILLS=200 cargo test --locked --features serve --test serve -- kills
	BOOKS_RUNS=10000 cargo test --locked -p pump-bench --test books

# All 10,000 random doses on heads whose flow reverses; `make test` draws 1000. Doses of 500 bought heads; `make test`
# draws 40. Sittings of setup with 500 drawn pumps; `make test` plays 10. 10,000 random plans for the clocks of Klipper
# boards; `make test` draws 500. An hour of a slow dose by the node's firmware, 500 stops and 2,000 cuts of its link;
# `make node` makes 5 minutes, 30 and 200. Then the wheels, and the Windows program under wine.
long: node-pico
	REVERSING_DOSES=10000 cargo test --locked -p pump-ctl --test reversing random_doses
	BOUGHT_HEADS=500 cargo test --locked -p pump-bench --test books bought_heads
	SETUP_DRAWS=500 cargo test --locked --test setup drawn_pump
	COVERAGE_PUMPS=2000 cargo test --locked -p pump-bench --lib coverage
	PRIOR_PUMPS=2000 cargo test --locked -p pump-bench --lib prior_coverage
	KLIPPER_PLANS=10000 cargo test --locked -p pump-bench --features klipper --lib refit
	KLIPPER_KILLS=200 cargo test --locked --test klipper -- kills
	cargo run --locked -p check-node $(FIRMWARE) slow 60
	cargo run --locked -p check-node $(FIRMWARE) stops 500
	cargo run --locked -p check-node $(FIRMWARE) cuts 2000
	$(MAKE) wheels
	$(MAKE) windows

# Each target for FUZZ_SECONDS, from the seeds in fuzz/corpus. What else it finds worth keeping is in target/fuzz; a crash is
# kept in fuzz/artifacts and belongs into a test.
FUZZ_SECONDS ?= 60
FUZZ := PATH="$(CURDIR)/target/tools/bin:$$PATH" cargo +nightly fuzz
fuzz:
	rustup toolchain install nightly --profile minimal
	test -x target/tools/bin/cargo-fuzz || cargo install cargo-fuzz --locked --root target/tools
	for target in quantities pump_files journals grbl_replies grbl_motions node_frames host_frames; do \
		mkdir -p target/fuzz/$$target && \
		$(FUZZ) run --target-dir target/fuzz-build $$target target/fuzz/$$target fuzz/corpus/$$target -- -max_total_time=$(FUZZ_SECONDS) || exit 1; \
	done

# Without the peers of `make bench`, which take minutes to compile and are checked there. Node.js runs pyright, which checks
# a script as a user writes it, strictly, as mypy does.
lint: $(VENV)/installed
	cargo fmt --version >/dev/null 2>&1 || rustup component add rustfmt
	cargo clippy --version >/dev/null 2>&1 || rustup component add clippy
	cargo fmt --all --check
	cargo fmt --manifest-path tests/no_panic/Cargo.toml --check
	cargo fmt --manifest-path demo/Cargo.toml --check
	cargo clippy --locked --workspace --exclude pump-benches --all-targets --features serve -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --exclude pump-benches --features serve --no-deps --document-private-items
	cd crates/pump-py && $(BIN)/ruff check . && $(BIN)/ruff format --check .
	cd tests/browser && $(BIN)/ruff check . ../../book && $(BIN)/ruff format --check . ../../book
	$(BIN)/ruff check --config tests/browser/pyproject.toml demo packaging
	$(BIN)/ruff format --config tests/browser/pyproject.toml --check demo packaging
	cd crates/pump-py && $(BIN)/mypy python tests examples gallery
	cd crates/pump-py && $(BIN)/python -m mypy.stubtest pumpmodel --mypy-config-file pyproject.toml --allowlist stubtest.txt
	command -v node || (apt-get update && apt-get install -y --no-install-recommends nodejs)
	$(BIN)/pyright --project crates/pump-py/tests/docs --pythonpath $(BIN)/python

# Each feature alone, none and all: no file may count on a feature that it did not ask for, and the tests that need none
# pass with none. Tests are checked with none and with all, and `make test` runs them with all.
features:
	cargo test --locked -p pump-model
	cargo clippy --locked -p pump-model --all-targets -- -D warnings
	for feature in $(MODEL_FEATURES); do \
		cargo clippy --locked -p pump-model --features $$feature -- -D warnings || exit 1; \
	done
	cargo clippy --locked -p pump-model --all-targets --all-features -- -D warnings
	cargo clippy --locked -p pump-ctl -- -D warnings
	cargo clippy --locked -p pump-ctl --features serde,defmt -- -D warnings
	cargo clippy --locked -p pump-link --all-targets -- -D warnings
	cargo clippy --locked -p pump-node --all-targets -- -D warnings
	cargo clippy --locked -p pump-service -- -D warnings
	cargo clippy --locked -p pump-dose --bins -- -D warnings
	cargo clippy --locked -p pump-bench -- -D warnings
	for feature in balance grbl klipper node plot; do cargo clippy --locked -p pump-bench --features $$feature -- -D warnings || exit 1; done

# The oldest Rust that is promised builds the libraries and the command.
oldest:
	rustup toolchain install $(OLDEST) --profile minimal
	cargo +$(OLDEST) check --locked -p pump-model -p pump-ctl -p pump-link -p pump-node -p pump-bench -p pump-service -p pump-dose

# Programs outside the workspace, built from the crates as they are published. Each crate must build from its package
# alone.
# Cargo takes a version that it has unpacked or built once for the same for ever, so each run has a folder of its own.
PACKAGED := pump-model pump-ctl pump-link pump-node pump-bench pump-service pump-dose
OUTSIDE := --manifest-path examples/outside/Cargo.toml --target-dir target/outside
packages:
	mkdir -p target && rm -rf target/package target/packaging.*
	folder=target/packaging.$$$$ && \
		cargo package --locked --allow-dirty --target-dir $$folder $(PACKAGED:%=-p %) && \
		mv $$folder/package target/package && rm -rf $$folder
	cargo fmt --manifest-path examples/outside/Cargo.toml --all --check
	cargo clippy --locked $(OUTSIDE) -p step-generator -- -D warnings
	cargo test --locked $(OUTSIDE) -p step-generator
	cargo run --locked $(OUTSIDE) -p motor-drive
	cargo run --locked $(OUTSIDE) -p line-model

# Releases beside the crates, as far as one Linux can make it: spelling, the notes of a release, its workflow by a
# linter, and a package of Debian that is installed, doses and goes again. npm keeps what it fetches within the checkout.
TOOLS := .venv-packaging
packaging: $(TOOLS)/installed
	$(TOOLS)/bin/typos
	$(TOOLS)/bin/python -m pytest -q -p no:cacheprovider packaging
	command -v npm || (apt-get update && apt-get install -y --no-install-recommends nodejs npm)
	cd packaging && npm ci --no-audit --no-fund --cache ../target/npm && node lint_workflows.mjs ../.github/workflows/*.yml
	cargo build --locked --features serve,man --bin dose
	rm -rf target/texts && packaging/texts target/debug/dose target/texts
	packaging/deb/build target/debug/dose target/texts target/pump-dose.deb
	packaging/deb/try target/pump-dose.deb

# The command with its service compiles for Windows and macOS: two minutes of a processor from nothing.
other-systems: $(TOOLS)/installed
	rustup target add x86_64-pc-windows-gnu aarch64-apple-darwin
	for target in x86_64-pc-windows-gnu aarch64-apple-darwin; do \
		PATH="$(CURDIR)/$(TOOLS)/bin:$$PATH" cargo-zigbuild check --locked --features serve -p pump-dose --target $$target || exit 1; \
	done

# The Windows program doses under wine, which lacks a library before version 9.
windows: $(TOOLS)/installed
	rustup target add x86_64-pc-windows-gnu
	PATH="$(CURDIR)/$(TOOLS)/bin:$$PATH" cargo-zigbuild build --locked --features serve --bin dose --target x86_64-pc-windows-gnu
	$(TOOLS)/bin/python -m ziglang cc -target x86_64-windows-gnu -shared -o target/x86_64-pc-windows-gnu/debug/bcryptprimitives.dll packaging/wine/bcryptprimitives.c -ladvapi32
	command -v wine || (apt-get update && apt-get install -y --no-install-recommends wine wine64)
	rm -rf target/wine && WINEPREFIX=$(CURDIR)/target/wine WINEDEBUG=-all timeout 300 wine target/x86_64-pc-windows-gnu/debug/dose.exe 25mL

# A wheel for Linux with a glibc from 2014 on, and the source: each is installed into an environment of its own, and doses.
wheels: $(TOOLS)/installed
	rm -rf target/wheels
	PATH="$(CURDIR)/$(TOOLS)/bin:$$PATH" maturin build --locked --release --manifest-path crates/pump-py/Cargo.toml --zig --compatibility manylinux2014 --out target/wheels
	$(TOOLS)/bin/maturin sdist --manifest-path crates/pump-py/Cargo.toml --out target/wheels
	for package in target/wheels/*.whl target/wheels/*.tar.gz; do \
		rm -rf target/wheel-venv && $(PYTHON) -m venv target/wheel-venv && \
		target/wheel-venv/bin/pip install --quiet $$package && \
		(cd target && wheel-venv/bin/python -c "import pumpmodel as pm; print(pm.Doser(pm.Pump.three_roller()).plan('25mL', rate='5 mL/s', start_angle_rad=0.0))") || exit 1; \
	done

$(TOOLS)/installed: packaging/requirements.txt
	$(PYTHON) -m venv $(TOOLS)
	$(TOOLS)/bin/pip install --quiet -r $<
	touch $@

# Beside other solvers: the peers take minutes to compile, and only here. The log of 100,000 doses beside serde_json alone.
bench: $(VENV)/installed
	cargo clippy --locked -p pump-benches --all-targets -- -D warnings
	cargo bench --locked -p pump-bench --bench log
	cargo run --locked --release -p pump-benches
	cargo bench --locked --features serve --bench serve
	$(BIN)/pip install --quiet "./crates/pump-py[bench]"
	$(BIN)/python crates/pump-py/benches/scipy_peers.py
	$(BIN)/python crates/pump-py/benches/before_after.py
	cargo build --locked --release --bin dose
	$(BIN)/python crates/pump-py/benches/growth.py target/release/dose

# Writes docs/validation.md and its pictures; fails where a deviation exceeds its bound. `cargo run --example validate -- PT1`
# repeats one of the paper's tests.
validate:
	cargo run --locked --example validate

# Writes docs/accuracy.md and its pictures.
accuracy:
	cargo run --locked --example accuracy

# Writes docs/pulse_prior.md, the default pulse of bought heads from published drawings.
pulse-prior:
	cargo run --locked --example pulse_prior

# The integrator too must do without std; what firmware needs must link without a panic, for size and for speed. The last
# line is the test of that test: an index that may be out of range must not link.
embedded: node-pico
	rustup target add $(TARGETS)
	for target in $(TARGETS); do cargo build --locked -p pump-model --features experimental,identification --target $$target || exit 1; done
	cargo build --locked -p pump-ctl --features serde,defmt --target thumbv7em-none-eabihf
	for target in $(TARGETS); do cargo build --locked -p pump-node --target $$target || exit 1; done
	for target in $(TARGETS); do $(NO_PANIC) --release --target $$target || exit 1; done
	for target in $(TARGETS); do $(NO_PANIC) --profile fast --target $$target || exit 1; done
	$(NO_PANIC) --release --target thumbv7em-none-eabihf --features index 2>&1 | grep 'undefined symbol: a_panic_is_reachable'
	command -v qemu-system-arm || (apt-get update && apt-get install -y --no-install-recommends qemu-system-arm)
	cd examples/firmware && cargo fmt --check
	cd examples/firmware && cargo clippy --locked --release --target-dir ../../target -- -D warnings
	cd examples/firmware && cargo build --locked --release --target-dir ../../target
	cd examples/firmware && timeout 60 cargo run --locked --release --target-dir ../../target --bin by_interrupt
	cd examples/firmware && timeout 60 cargo run --locked --release --target-dir ../../target --bin by_rtic
	cd examples/firmware && timeout 300 cargo run --locked --release --target-dir ../../target >../../target/firmware.txt
	cargo run --locked -p check-firmware target/firmware.txt
	cd firmware/emulated && cargo fmt --check
	cd firmware/emulated && cargo clippy --locked --release --target-dir ../../target -- -D warnings
	cd firmware/emulated && cargo build --locked --release --target-dir ../../target
	cargo build --locked -p check-node
	timeout 300 cargo run --locked -p check-node --bin check-node-mps2 $(EMULATED) one
	timeout 300 cargo run --locked -p check-node $(FIRMWARE) one

# The node's firmware for the mps2-an386, which QEMU emulates. `make embedded` makes one dose with it and one with the
# Pico's, `make node` more.
EMULATED := target/thumbv7em-none-eabihf/release/pump-node-emulated

# The node's firmware for the Raspberry Pi Pico, to be dragged onto its drive.
FIRMWARE := target/thumbv6m-none-eabi/release/pump-node-pico
firmware:
	rustup target add thumbv6m-none-eabi
	cd firmware/pico && cargo build --locked --release --target-dir ../../target
	test -x target/tools/bin/elf2uf2-rs || cargo install elf2uf2-rs --locked --no-default-features --root target/tools
	target/tools/bin/elf2uf2-rs $(FIRMWARE) target/pump-node.uf2

# The firmware for the Pico and the emulator that runs it. npm keeps what it fetches within the checkout.
node-pico:
	rustup target add thumbv6m-none-eabi
	command -v npm || (apt-get update && apt-get install -y --no-install-recommends nodejs npm)
	cd firmware/emulator && npm ci --no-audit --no-fund --cache ../../target/npm
	cd firmware/pico && cargo build --locked --release --target-dir ../../target

# Doses by the drive of the node with the firmware of two boards in emulators, and holds the edges of their pins against
# the plan. Time is the boards', so a slow computer makes this slow and changes no result. Two idle cores take less than
# 15 minutes in all, and each part says its own time. The part `command` runs the command in real time. `check-node
# FIRMWARE.elf PART [NUMBER]` makes one part.
node: node-pico
	cd firmware/pico && cargo fmt --check
	cd firmware/pico && cargo clippy --locked --release --target-dir ../../target -- -D warnings
	$(COMMAND)
	cargo build --locked -p check-node
	$(MAKE) firmware
	cargo run --locked -p check-node $(FIRMWARE) uf2 target/pump-node.uf2
	timeout 1500 cargo run --locked -p check-node $(FIRMWARE)
	timeout 300 node firmware/emulator/klipper.mjs
	rustup target add thumbv7em-none-eabihf
	command -v qemu-system-arm || (apt-get update && apt-get install -y --no-install-recommends qemu-system-arm)
	cd firmware/emulated && cargo build --locked --release --target-dir ../../target
	timeout 900 cargo run --locked -p check-node --bin check-node-mps2 $(EMULATED)

# The guide, from docs/, with the reference of the Python module and the gallery's notebooks, which are executed. It fails
# where a link leads nowhere.
BOOK := .venv-book
docs: $(BOOK)/installed $(VENV)/installed
	cd book && $(CURDIR)/$(BOOK)/bin/python -m pytest -q -p no:cacheprovider
	$(BOOK)/bin/python book/notebooks.py crates/pump-py/gallery \
		$$($(BIN)/python -c "import sysconfig; print(sysconfig.get_path('platlib'))") target/notebooks
	PATH="$(CURDIR)/$(BOOK)/bin:$$PATH" mdbook build book
	mkdir -p target/guide/gallery && cp target/notebooks/*.ipynb target/guide/gallery
	$(PYTHON) book/check.py target/guide docs

$(BOOK)/installed: book/requirements.txt
	$(PYTHON) -m venv $(BOOK)
	$(BOOK)/bin/pip install --quiet -r $<
	touch $@

# The documentation of the crates.
api:
	cargo doc --locked --workspace --no-deps --open
