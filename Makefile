# Each line is a command that a person could type.
PYTHON ?= python3
VENV := .venv
TARGETS := thumbv7em-none-eabihf thumbv6m-none-eabi riscv32imc-unknown-none-elf

.PHONY: test test-rust test-python lint bench embedded docs

test: test-rust test-python

test-rust:
	cargo test --locked

test-python: $(VENV)/installed
	$(VENV)/bin/python -m pytest crates/pump-py/tests

# Installed anew whenever a source of the Python module has changed.
$(VENV)/installed: $(shell git ls-files -- Cargo.lock Cargo.toml 'src/*.rs' 'crates/*/src/*' 'crates/pump-py/*.toml' 'crates/pump-py/python/*')
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/pip install --quiet "./crates/pump-py[test]"
	touch $@

lint: $(VENV)/installed
	cargo fmt --version >/dev/null 2>&1 || rustup component add rustfmt
	cargo clippy --version >/dev/null 2>&1 || rustup component add clippy
	cargo fmt --all --check
	cargo clippy --locked --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps --document-private-items
	$(VENV)/bin/ruff check crates/pump-py
	$(VENV)/bin/ruff format --check crates/pump-py
	$(VENV)/bin/mypy --strict crates/pump-py/tests
	$(VENV)/bin/python -m mypy.stubtest pumpmodel

bench:
	cargo bench --locked

# One build a target: building the workspace at once would unify features.
embedded:
	rustup target add $(TARGETS)
	for target in $(TARGETS); do cargo build --locked -p pump-ctl --target $$target || exit 1; done

docs:
	cargo doc --locked --workspace --no-deps --open
