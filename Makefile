# Two commands do everything on a fresh Debian machine with Rust, Python and a
# C compiler: `make fly` and `make test`. Each installs what it lacks.

AIRCRAFT ?= c172p
LEGS     ?= 8
SEED     ?= 1
JSON     ?= target/fly-jsbsim-$(AIRCRAFT).json
PLOT     ?= $(basename $(JSON)).png
# The UDP port on which the stand-in listens, X-Plane's own unless it is taken.
PORT     ?= 49000
# Faults of network and sensors for fly-jsbsim, such as
# HARSH="--loss 0.02 --duplicate 0.01 --reorder 0.01 --noise".
HARSH    ?=
# For bench-live, such as LIVE="--seconds 60 --watchers 200".
LIVE     ?=

# For bench-timing, such as TIMING="--rates 40 --seconds 20 --rounds 5".
TIMING   ?=

# For soak, such as SOAK="--minutes 5 --rate 1000".
SOAK     ?=

# Where a goal that measures writes its section of a page: RESULTS=docs/results replaces it there.
RESULTS  ?= target/results
# The first seed of flights that are reported (docs/campaign.md).
REPORTED := 200201
# $(call result,PAGE,TITLE,VARIABLE) runs what follows, and writes its section.
result    = FCC_FIRST_SEED=$(REPORTED) $(PYTHON) scripts/results $(RESULTS)/$(1).md $(2) \
    'make $@$(if $($(3)), $(3)="$($(3))")'

# The target folder of `cargo`.
TARGET   := $(or $(CARGO_TARGET_DIR),target)
FCCD     := $(TARGET)/release/fccd
# The same with fault injection, for tests.
FAULTY   := $(TARGET)/release/fccd-faulty
# What tests run: built by `tested`.
TESTED   := $(abspath $(TARGET))/ci
# The folder of the Python module's wheels.
WHEELS   := $(TARGET)/wheels
# A workspace of its own, built with the same compiler.
TIMING_TARGET := $(abspath $(TARGET))/bench-timing
BENCH_TIMING  := cargo build --locked --release --manifest-path bench/timing/Cargo.toml --target-dir $(TIMING_TARGET)
# As in Cargo.lock: runner and library have to be of one version.
GUNGRAUN := 0.20.0
VENV     := .venv
PYTHON   := $(VENV)/bin/python
STAMPS   := .stamps

# What is built once needs no intermediate results for the next time: several GB.
ifdef CI
export CARGO_INCREMENTAL := 0
endif

# Two goals build the same program with and without faults.
.NOTPARALLEL:

GOALS := advisories android android-check android-package bench bench-android bench-flight \
    bench-flood bench-ground bench-live bench-peer bench-timing book build campaign check-boards \
    check-cross clean clippy deb deny doc faulty fly fly-jsbsim fly-plan fly-plan-jsbsim fuzz \
    ground help lint lint-python lint-rust lock package-check python reproducible soak soundness \
    station test test-android test-attacks test-calibration test-contingencies test-cross test-deb \
    test-drawn-fences test-fences test-multicopter test-full test-glides test-ground test-guidance test-landings \
    test-landings-beside test-mavlink test-navigation test-page test-plan-real-time test-python \
    test-quick test-raw-edges test-recordings test-release test-rust test-seeds test-upsets \
    test-vm test-x-plane tested wheels

.PHONY: $(GOALS)

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { print $$1 "\t" $$2 }' $(MAKEFILE_LIST) | LC_ALL=C sort | \
	awk -F '\t' '{ line = sprintf("  make %-21s", $$1); n = split($$2, words, " "); \
	    for (i = 1; i <= n; i++) { if (length(line) + length(words[i]) > 79) { print line; line = sprintf("%28s", "") } \
	        line = line " " words[i] } print line }'

# With the features that libraries have in the Python module, which shares them then: `cargo`
# chooses those of all packages that are named. Of these only the daemon is built.
BUILD_FCCD := cargo build --locked --release -p fcc-daemon -p fcc-py --bin fccd

build: $(STAMPS)/rust ## Build target/release/fccd
	$(BUILD_FCCD)

VEHICLE ?= aeroplane

fly: build ## Fly a built-in vehicle in real time: aeroplane or multicopter (VEHICLE=)
	$(FCCD) fly --vehicle $(VEHICLE)

# For ground, such as GROUND_STATION="--listen 0.0.0.0:8460".
GROUND_STATION ?=

# With the page in it.
station: $(STAMPS)/rust $(STAMPS)/page
	cargo build --locked --release -p fcc-daemon -p fcc-py -p fcc-ground --bin fcc-ground

# Unoptimised but for the loop, which compiles in a third of the time of what ships.
ground: $(STAMPS)/rust $(STAMPS)/page ## Draw plans in a browser, fly them with the built-in aircraft, and watch (GROUND_STATION=)
	cargo build --locked -p fcc-daemon -p fcc-ground --bin fccd --bin fcc-ground
	FCCD=$(TARGET)/debug/fccd STATION=$(TARGET)/debug/fcc-ground ./scripts/ground $(GROUND_STATION)

python: $(STAMPS)/python-module ## Make .venv, with the Python module and the tools of hil/

fly-jsbsim: build $(STAMPS)/python ## Fly JSBSim's Cessna over X-Plane's protocol (AIRCRAFT= LEGS= JSON= PORT= HARSH=)
	@mkdir -p $(dir $(JSON)) target
	@sed 's/:49000"/:$(PORT)"/' config/x-plane.toml > target/x-plane.toml
	$(PYTHON) -m fcc_hil fly --aircraft $(AIRCRAFT) --legs $(LEGS) --seed $(SEED) --port $(PORT) \
	    --fccd $(FCCD) --config target/x-plane.toml --json $(JSON) --plot $(PLOT) $(HARSH)

PLAN ?= config/plans/circuit.waypoints
WIND ?= 8
WIND_FROM ?= 270
# A folder of elevation tiles (.hgt), for fly-plan-jsbsim.
TERRAIN ?=

fly-plan: build ## Fly a plan with the built-in aircraft, as fast as it computes, and draw it (PLAN= WIND= WIND_FROM=)
	@mkdir -p target
	@sed 's/^#wind_kt = 0.0/wind_kt = $(WIND)/; s/^#wind_from_deg = 0.0/wind_from_deg = $(WIND_FROM)/' \
	    config/built-in.toml > target/fly-plan.toml
	$(FCCD) fly --config target/fly-plan.toml --lockstep --quiet --plan $(PLAN) --recordings target/fly-plan
	$(FCCD) report --html target/fly-plan.html $$(ls -t target/fly-plan/*.mcap | head -1) > /dev/null
	@echo "the ground track is in target/fly-plan.html"

fly-plan-jsbsim: build $(STAMPS)/python-module ## Fly a plan with JSBSim over X-Plane's protocol, in real time, scored from its truth (PLAN= WIND= WIND_FROM= SEED= JSON= TERRAIN=)
	@mkdir -p target
	$(PYTHON) -m fcc_hil plan --realtime --fccd $(FCCD) --plan $(PLAN) --wind $(WIND) --wind-from $(WIND_FROM) --seed $(SEED) \
	    $(if $(TERRAIN),--terrain $(TERRAIN)) --json $(if $(filter-out file,$(origin JSON)),$(JSON),target/fly-plan-jsbsim.json) --plot target/fly-plan-jsbsim.png

# Flights in lockstep, and what documents and the module's stub say.
QUICK := $(patsubst %,hil/tests/test_%.py,actions air_data altimeter bad_readings degraded documents \
    documented_keys fault_table fcc_autopilot fcc_flight fcc_stub floor lockstep pattern pilot_takeover \
    release score upset)
# Rust tests that wait for real time, by parts of their names.
REAL_TIME := timerfd:: posix:: nanosleep:: early:: thread:: watchdog:: slow_disk:: full_disk:: \
    lines:: real_gpsd:: finding:: following::

# Three layers: between changes, before a commit, and before a problem counts as solved.
test-quick: clippy tested ## Check what takes no real time: lints, Rust, a choice of flights in lockstep (6 minutes)
	cargo test --locked --workspace --all-features --lib --bins --tests -- $(addprefix --skip ,$(REAL_TIME))
	$(WITH_TESTED) $(PYTHON) -m pytest --numprocesses auto $(QUICK)

test: lint check-cross test-rust test-python test-page ## Run every check and every test, long flights left out (20 minutes)

# Every goal whose name begins with `test-`: a new one cannot be forgotten.
FULL := $(filter-out test-quick test-full test-recordings,$(filter test-%,$(GOALS)))
test-full: test check-boards $(FULL) $(if $(MCAP_TOOL),test-recordings) ## Run `make test` and every longer test (5 hours; MCAP_TOOL=)
	@echo "passed: test check-boards $(FULL) $(if $(MCAP_TOOL),test-recordings)"
	@$(if $(MCAP_TOOL),,echo "not run: test-recordings: it needs MCAP_TOOL=PATH")

test-rust: $(STAMPS)/rust $(STAMPS)/gpsd
	cargo test --locked --workspace --all-features
	cargo check --locked -p fcc-daemon -p fcc-ground -p fcc-py
	cargo check --locked -p fcc-daemon -p fcc-py --no-default-features
	@for crate in fcc-runtime fcc-telemetry fcc-record fcc-live fcc-replay fcc-report fcc-top thermostat pendulum; do \
	    ! cargo tree --locked -p $$crate -e no-dev | grep -E 'fcc-(navigation|guidance|calibration|fixed-wing|multicopter)' || \
	    { echo "$$crate is compiled with an aircraft: see above"; exit 1; }; done
	@for crate in fcc-daemon fcc-ground fcc-py fcc-android; do \
	    ! cargo tree --locked -p $$crate -e no-dev,features | grep -E 'fault-injection|fcc-conformance' || \
	    { echo "$$crate is compiled with what is for tests: see above"; exit 1; }; done

# One more than there are processors: a third of the tests wait for flights in real time.
WORKERS := $(shell expr $$(nproc) + 1)

WITH_TESTED := FCCD=$(TESTED)/fccd FCCD_INJECTION=$(TESTED)/fccd FCC_GROUND=$(TESTED)/fcc-ground \
    FCC_LOCKSTEP=$(TESTED)/examples/lockstep

test-python: tested $(STAMPS)/strace $(STAMPS)/systemd $(STAMPS)/node
	$(WITH_TESTED) $(PYTHON) -m pytest hil --numprocesses $(WORKERS) --dist loadfile

IN_BROWSER := $(PYTHON) -m pytest web/tests --numprocesses $(WORKERS)

test-page: tested $(STAMPS)/browser ## Check the page, and test it in a browser beside real flights (3 minutes)
	cd web && npm run check
	$(WITH_TESTED) $(IN_BROWSER) --ignore web/tests/mock

test-ground: tested $(STAMPS)/browser ## Test the page beside real flights, and in flights that are made up (6 minutes)
	$(WITH_TESTED) $(IN_BROWSER)

pictures: tested $(STAMPS)/browser ## Take the pictures of the ground station in the documents anew (4 minutes)
	FCC_PICTURES=web/pictures $(WITH_TESTED) $(PYTHON) -m pytest web/tests/test_pictures.py

WITH_RELEASED := FCC_RELEASED=1 FCCD=$(abspath $(FCCD)) FCCD_INJECTION=$(abspath $(FAULTY)) FCC_GROUND=$(abspath $(TARGET))/release/fcc-ground

test-release: faulty station $(STAMPS)/python-module $(STAMPS)/browser $(STAMPS)/strace $(STAMPS)/systemd $(STAMPS)/node ## Run the tests in Python and in a browser with what ships (40 minutes)
	$(BUILD_FCCD) -p thermostat --bin thermostat
	$(WITH_RELEASED) $(PYTHON) -m pytest hil --numprocesses $(WORKERS) --dist loadfile
	$(WITH_RELEASED) $(IN_BROWSER) --ignore web/tests/mock

# Seconds of the stream that node-mavlink decodes.
FCC_MAVLINK_SECONDS ?= 3600
MAVLINK_STREAM := $(abspath $(TARGET))/mavlink-stream

test-mavlink: tested $(STAMPS)/node ## Decode an hour of MAVLink by node-mavlink; test missions on lossy and cut links (5 minutes; FCC_MAVLINK_SECONDS=)
	FCC_MAVLINK_SECONDS=$(FCC_MAVLINK_SECONDS) FCC_MAVLINK_STREAM=$(MAVLINK_STREAM) \
	    cargo test --locked -p fcc-mavlink --test it
	FCC_MAVLINK_SECONDS=$(FCC_MAVLINK_SECONDS) FCC_MAVLINK_STREAM=$(MAVLINK_STREAM) \
	    $(WITH_TESTED) $(PYTHON) -m pytest --capture=no hil/tests/test_mavlink_node.py
	rm -f $(MAVLINK_STREAM)

test-x-plane: tested ## Run all steps of `fccd x-plane check` in full against the stand-in (3 minutes)
	FCCD_FULL_CHECK=1 FCCD=$(TESTED)/fccd $(PYTHON) -m pytest hil/tests/test_x_plane_check.py

ATTACKS := hil/tests/test_release_helper.py::test_whoever_is_killed_the_controls_are_released_in_the_end \
           hil/tests/test_shared_memory.py::test_whoever_damages_shared_memory_the_flight_goes_on

test-attacks: tested ## Kill daemon and helper 100 times, and damage shared memory 100 times, in flight (15 minutes)
	FCCD_KILLS=100 FCCD_ATTACKS=100 FCCD=$(TESTED)/fccd $(PYTHON) -m pytest --capture=no $(ATTACKS)

UPSETS := hil/tests/test_drawn_upsets.py \
          hil/tests/test_envelope_speed.py::test_climbing_turns_at_75_kt_do_not_stall

test-upsets: tested ## Recover from 100 drawn upsets, and fly 60 flights of climbing turns in turbulence (5 minutes)
	FCCD_UPSETS=100 FCCD_CLIMBING_TURNS=20 $(PYTHON) -m pytest --capture=no $(UPSETS)

# Those with `first_of`.
SEEDS := hil/tests/test_margins.py hil/tests/test_raw_failures.py hil/tests/test_raw_static_port.py

test-seeds: tested ## Fly what `make test` flies with one seed with all of them (3 minutes)
	FCC_SEEDS=1 $(PYTHON) $(SEVERAL) $(SEEDS)

EDGES := hil/tests/test_upset.py hil/tests/test_floor.py hil/tests/test_release.py hil/tests/test_envelope_speed.py

test-raw-edges: tested ## Fly the edges of flight by the raw sensors of a board, and of a phone (4 minutes)
	FCC_RAW_SENSORS=board $(PYTHON) -m pytest $(EDGES)
	FCC_RAW_SENSORS=phone $(PYTHON) -m pytest $(EDGES)

# As many at a time as there are processors, and all of what they print.
SEVERAL := -m pytest --numprocesses auto -rA --show-capture=stdout

test-fences: tested ## Fly 20 times against a fence with JSBSim, in 20 kt and turbulence (10 minutes)
	FCC_FENCES=20 $(call result,plans,Fences) $(PYTHON) $(SEVERAL) hil/tests/test_contingency.py

# How often each contingency is flown.
EACH ?= 20

test-contingencies: tested ## Lose position, commander and battery, and meet ridges, each 20 times with JSBSim (EACH=, 40 minutes)
	FCC_FENCES=0 FCC_CONTINGENCIES=$(EACH) $(call result,plans,Contingencies,EACH) $(PYTHON) $(SEVERAL) hil/tests/test_contingency.py

test-glides: tested ## Stop the engine at 3,000 ft and glide down 20 times with JSBSim (10 minutes)
	FCC_GLIDES=20 $(call result,landings,Glides) $(PYTHON) -m pytest --capture=no hil/tests/test_glide.py

test-guidance: tested ## Fly 12 legs in five winds and circles with JSBSim, by both laws (15 minutes)
	FCC_GUIDANCE=1 $(call result,plans,Guidance) $(PYTHON) $(SEVERAL) hil/tests/test_guidance.py

test-landings: tested ## Take off, fly a circuit and land 100 times with JSBSim, in five winds (25 minutes)
	FCC_LANDINGS=20 FCCD=$(TESTED)/fccd $(call result,landings,Circuits) $(PYTHON) $(SEVERAL) hil/tests/test_landing.py

test-landings-beside: tested ## The same 60 times: other aircraft, a plain receiver without a range finder (20 minutes)
	FCC_LANDINGS=0 FCC_LANDINGS_BESIDE=4 FCCD=$(TESTED)/fccd \
	    $(call result,landings,'Other aircraft and sensors') $(PYTHON) $(SEVERAL) hil/tests/test_landing.py

test-navigation: tested ## Fly the pattern by the raw sensors of a phone and of a board, with 6 seeds (5 minutes)
	FCC_NAVIGATION=6 $(call result,navigation,'The timed pattern') $(PYTHON) $(SEVERAL) \
	    hil/tests/test_raw_sensors.py hil/tests/test_raw_without_airspeed.py

test-calibration: $(STAMPS)/rust $(STAMPS)/python ## Calibrate the simulated sensors with 8 seeds (1 minute)
	$(call result,calibration,'Errors that are left') cargo test --locked -p fcc-sim --test it handling

test-multicopter: $(STAMPS)/rust $(STAMPS)/python ## Hover, step, fly a plan and land the built-in multicopter, in wind (1 minute)
	$(call result,vehicles,Multicopter) cargo test --locked -p fcc-multicopter --test flights

test-drawn-fences: $(STAMPS)/rust $(STAMPS)/python ## Fly the built-in aircraft against 1,100 drawn fences (5 minutes)
	$(call result,plans,'Drawn fences') cargo test --locked --profile ci -p fcc-flight --test it drawn_fences

test-plan-real-time: tested ## Fly legs by a plan with JSBSim over X-Plane's protocol, longer than in `make test` (2 minutes)
	FCC_PLAN_REAL_TIME=1 FCCD=$(TESTED)/fccd $(PYTHON) -m pytest hil/tests/test_plan_real_time.py

test-recordings: tested ## Copy 100 recordings by each command of MCAP's tool, and replay them (MCAP_TOOL=, 10 minutes)
	@test -x "$(MCAP_TOOL)" || { echo "MCAP_TOOL=PATH: MCAP's command line tool, https://mcap.dev/guides/cli"; exit 2; }
	MCAP_TOOL=$(MCAP_TOOL) MCAP_FLIGHTS=100 FCCD=$(TESTED)/fccd $(PYTHON) -m pytest hil/tests/test_rewritten_recording.py

# The app's classes and its native library, on this machine's Java. Its own report of
# what native code does wrong (-Xcheck:jni) is in the output and no failure by itself.
ANDROID := target/android
test-android: tested $(STAMPS)/java $(STAMPS)/aapt ## Test the app and its native library under Java, and fly JSBSim by it (15 minutes)
	@mkdir -p $(ANDROID)/faulty
	cargo build --locked -p fcc-android --features fault-injection
	cp $(TARGET)/debug/libfcc_android.so $(ANDROID)/faulty/
	cargo build --locked -p fcc-android -p fake-libandroid
	cd android/tests && mvn --quiet --batch-mode -Dlibrary=$(abspath $(TARGET))/debug test \
	    > $(abspath $(ANDROID))/host-tests.log 2>&1 || { cat $(abspath $(ANDROID))/host-tests.log; exit 1; }
	for sdk in 28 35; do \
	    (cd android/tests && mvn --quiet --batch-mode --offline -Dlibrary=$(abspath $(TARGET))/debug \
	        -Dsdk=$$sdk surefire:test@app) > $(abspath $(ANDROID))/host-tests-$$sdk.log 2>&1 || \
	        { cat $(abspath $(ANDROID))/host-tests-$$sdk.log; exit 1; }; \
	done
	@! grep -E 'WARNING in native method|WARNING: JNI|FATAL ERROR in native' $(ANDROID)/host-tests.log
	FCC_ANDROID=$(abspath android/tests/fccd) FCC_ANDROID_LIBRARY=$(abspath $(TARGET))/debug \
	    FCCD=$(TESTED)/fccd $(PYTHON) -m pytest hil/tests/test_android.py

# For bench-android, such as ANDROID_TIMING="--rounds 2 --seconds 20 --rate 100".
ANDROID_TIMING ?=

bench-android: build $(STAMPS)/python $(STAMPS)/java $(STAMPS)/aapt ## Compare the loop's timing in the app with the daemon's, in turn (35 minutes; ANDROID_TIMING=)
	cargo build --locked --release -p fcc-android
	cd android/tests && mvn --quiet --batch-mode test-compile
	FCC_ANDROID_LIBRARY=$(abspath $(TARGET))/release $(call result,android,'The loop in the app',ANDROID_TIMING) \
	    $(PYTHON) -m fcc_hil bench-android --fccd $(FCCD) \
	    --app android/tests/timing-flight --json target/bench-android.json $(ANDROID_TIMING)

android: $(STAMPS)/rust ## Build the app for phones: needs Android's SDK and NDK, cargo-ndk and Gradle (docs/android.md)
	./scripts/android-build

android-check: $(STAMPS)/rust $(STAMPS)/android ## Check and link the app's native library for phones, without an NDK (10 minutes)
	./scripts/android-check $(TARGET)

android-package: $(STAMPS)/java $(STAMPS)/aapt ## Put the app together, unsigned and without its native library (after test-android)
	./scripts/android-package $(TARGET)

faulty: $(STAMPS)/rust
	$(BUILD_FCCD) --features fcc-daemon/fault-injection
	cp $(FCCD) $(FAULTY)

lint: lint-rust lint-python deny ## Check formatting, lints, licences

clippy: $(STAMPS)/rust
	cargo fmt --all --check
	./scripts/structure
	./scripts/words
	./scripts/messages --check
	cargo clippy --locked --workspace --all-targets --all-features -- -D warnings

lint-rust: clippy
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps --all-features

# Scripts in Python.
LINTED := $(addprefix scripts/,known-advisories android-check messages reference results structure words \
    book tables)

lint-python: tested $(STAMPS)/playwright
	$(PYTHON) -m ruff check hil deploy web
	$(PYTHON) -m ruff check --config hil/pyproject.toml crates/fcc-py/fcc.pyi $(LINTED)
	$(PYTHON) -m ruff format --check hil deploy web
	$(PYTHON) -m ruff format --config hil/pyproject.toml --check crates/fcc-py/fcc.pyi $(LINTED)
	cd hil && ../$(PYTHON) -m mypy
	cd deploy/vm && MYPYPATH=../../hil/tests ../../$(PYTHON) -m mypy --config-file ../../hil/pyproject.toml .
	cd web/tests && MYPYPATH=../../hil/tests ../../$(PYTHON) -m mypy --config-file ../../hil/pyproject.toml *.py

deny: $(STAMPS)/rust
	@command -v cargo-deny >/dev/null || cargo install --debug --locked --version 0.20.2 cargo-deny
	cargo deny --log-level error check bans licenses sources
	./scripts/advisories

advisories: $(STAMPS)/rust ## Check the crates against RustSec's advisories; fails if that cannot be done
	@command -v cargo-deny >/dev/null || cargo install --debug --locked --version 0.20.2 cargo-deny
	ADVISORIES=required ./scripts/advisories

lock: ## Lock the versions and hashes of the Python packages anew (needs uv)
	cd hil && $(LOCK) --extra build --extra test pyproject.toml -o locked.txt
	cd hil && $(LOCK) packaging.in -o locked-packaging.txt
	cd web/tests && $(LOCK) --constraint ../../hil/locked.txt playwright.in -o locked.txt

# For every Python from 3.10 and every machine.
LOCK := uv pip compile --quiet --upgrade --universal --generate-hashes --python-version 3.10 --custom-compile-command 'make lock'

reproducible: $(STAMPS)/rust ## Build the daemon of this commit in two folders, and compare (10 minutes)
	./scripts/reproducible $(TARGET)/reproducible

# Pinned, so that a new compiler does not change the result.
NIGHTLY := nightly-2026-05-20
# For fuzz: inputs for each target.
INPUTS  ?= 1000000
# `none` is three times as fast, and finds what is no error of memory.
SANITIZER ?= address

fuzz: ## Fuzz every parser of outside data, INPUTS= for each (needs a nightly toolchain)
	@command -v cargo-fuzz >/dev/null || cargo install --locked --version 0.13.2 cargo-fuzz
	NIGHTLY=$(NIGHTLY) SANITIZER=$(SANITIZER) ./scripts/fuzz $(INPUTS)

soundness: ## Run Miri and ThreadSanitizer over timers, loop, records and live telemetry (15 minutes)
	NIGHTLY=$(NIGHTLY) ./scripts/soundness

# The boards: a Raspberry Pi with 64 bits, and a BeagleBone or a Pi with 32.
BOARDS := aarch64-unknown-linux-gnu armv7-unknown-linux-gnueabihf
# The one that differs from this machine in more than its instructions: sizes, alignment.
NARROW := armv7-unknown-linux-gnueabihf
# Of servo boards: a Cortex-M0, and a Cortex-M4.
MICROCONTROLLERS := thumbv6m-none-eabi thumbv7em-none-eabi

# The whole workspace, as in the other checks: with another choice of packages some
# crates of build scripts have other features, and are compiled once more.
CHECK_BOARD := check --locked --workspace --all-features

check-cross: $(STAMPS)/cross ## Check that everything compiles for the board with 32 bits, and for servo boards
	./scripts/cross $(NARROW) $(CHECK_BOARD)
	for board in $(MICROCONTROLLERS); do \
	    cargo build --locked -p servo-board-firmware --target $$board || exit 1; \
	done

check-boards: check-cross ## Check that everything compiles for all boards
	for board in $(filter-out $(NARROW),$(BOARDS)); do \
	    ./scripts/cross $$board $(CHECK_BOARD) || exit 1; \
	done

test-cross: $(STAMPS)/cross $(STAMPS)/qemu build ## Build for the boards, and run the tests in emulation
	for board in $(BOARDS); do ./scripts/test-cross $$board $(FCCD) || exit 1; done

# Of this machine, or DEB_TARGET=aarch64-unknown-linux-gnu and the like.
DEB_TARGET ?=
PACKAGE    := target/package

deb: build station $(if $(DEB_TARGET),$(STAMPS)/cross) ## Make the Debian packages, and their bill of materials (DEB_TARGET=)
	@command -v cargo-deb >/dev/null || cargo install --locked --version 3.8.0 cargo-deb
	rm -rf $(PACKAGE) && mkdir -p $(PACKAGE)
	$(FCCD) man $(PACKAGE)/man
	$(FCCD) completions bash > $(PACKAGE)/fccd.bash
	$(FCCD) completions zsh > $(PACKAGE)/_fccd
	$(FCCD) completions fish > $(PACKAGE)/fccd.fish
	$(if $(DEB_TARGET),./scripts/cross $(DEB_TARGET),cargo) deb --locked -p fcc-daemon \
	    $(if $(DEB_TARGET),--target $(DEB_TARGET)) --output $(PACKAGE)/
	$(if $(DEB_TARGET),./scripts/cross $(DEB_TARGET),cargo) deb --locked -p fcc-ground \
	    $(if $(DEB_TARGET),--target $(DEB_TARGET)) --output $(PACKAGE)/
	./scripts/sbom $(PACKAGE)/fccd.cdx.json $(DEB_TARGET)

test-deb: deb $(STAMPS)/python $(if $(DEB_TARGET),$(STAMPS)/qemu) ## Test the content of the Debian package (DEB_TARGET=)
	DEB=$$(ls $(abspath $(PACKAGE))/fccd_*.deb) $(PYTHON) -m pytest deploy/tests

# A small Debian, built once. Its tests are in no other goal: without
# virtualization they take minutes.
VM_IMAGE := target/vm

test-vm: deb $(VM_IMAGE)/root.img $(STAMPS)/vm $(STAMPS)/python ## Boot a Debian in qemu, install the package there, and fly (8 minutes)
	DEB=$$(ls $(abspath $(PACKAGE))/fccd_*.deb) VM_IMAGE=$(abspath $(VM_IMAGE)) $(PYTHON) -m pytest deploy/vm

$(VM_IMAGE)/root.img: deploy/vm/build-image | $(STAMPS)/vm
	./deploy/vm/build-image $(VM_IMAGE)

bench: $(STAMPS)/rust build $(STAMPS)/python $(STAMPS)/strace $(STAMPS)/valgrind ## Measure the cost of a tick and of recording: time, instructions, memory, system calls (8 minutes)
	@test "$$(gungraun-runner --version 2>/dev/null)" = "gungraun-runner $(GUNGRAUN)" || \
	    cargo install --locked --version $(GUNGRAUN) gungraun-runner
	$(call result,timing,'Time of a tick') cargo bench --locked -p bench-tick --bench time -- --output-format bencher
	cargo bench --locked -p bench-tick --bench instructions
	cargo build --locked --release -p bench-tick
	$(call result,timing,'System calls and memory of a tick') $(TARGET)/release/costs
	$(call result,timing,Latency) $(TARGET)/release/latency --fccd $(FCCD)
	$(call result,timing,'Latency without early wake') \
	    $(TARGET)/release/latency --fccd $(FCCD) --with 'early_wake = { enabled = false }'
	$(call result,timing,"The thesis' experiment") $(FCCD) timing --timer posix --early-wake off --seconds 15
	FCC_RELEASED=1 FCCD=$(abspath $(FCCD)) $(call result,timing,Memory) \
	    $(PYTHON) -m pytest hil/tests/test_daemon_memory.py
	FCCD=$(abspath $(FCCD)) $(call result,recordings,'Bytes of a tick') \
	    $(PYTHON) -m pytest -k bytes hil/tests/test_recording_cost.py
	FCC_RECORDING_SECONDS=20 FCCD=$(abspath $(FCCD)) $(call result,recordings,'Processor time') \
	    $(PYTHON) -m pytest -k processor_time hil/tests/test_recording_cost.py

bench-timing: $(STAMPS)/rust $(STAMPS)/python $(STAMPS)/rt-tests ## Compare the clocks with other programs, idle and under stress (22 minutes; TIMING=)
	$(BENCH_TIMING) -p copper --features copper/high-precision
	cp $(TIMING_TARGET)/release/peer-copper $(TIMING_TARGET)/release/peer-copper-precise
	$(BENCH_TIMING)
	$(call result,timing,'Clocks and their peers',TIMING) $(TIMING_TARGET)/release/bench-timing \
	    --json target/bench-timing.json --plot $(if $(filter docs/results,$(RESULTS)),docs,target)/bench-timing.svg $(TIMING)

soak: $(STAMPS)/rust build $(STAMPS)/python $(STAMPS)/rt-tests ## Fly for half an hour at 100 Hz under stress, with cyclictest (SOAK=)
	@mkdir -p target
	$(call result,timing,'Under stress',SOAK) $(PYTHON) -m fcc_hil soak --fccd $(FCCD) --json target/soak.json $(SOAK)

bench-peer: $(STAMPS)/rust $(STAMPS)/python-module ## Fly the suite's two Cessnas and JSBSim's own autopilot
	$(PYTHON) -m fcc_hil suite --only 'c172[px]: *'

bench-flight: $(STAMPS)/rust $(STAMPS)/python-module ## Fly the suite: ten aircraft, all weathers, against stated limits
	@mkdir -p target
	$(call result,flight,Suite) $(PYTHON) -m fcc_hil suite --json target/suite.json --picture target/suite.png

# For campaign, such as CAMPAIGN="--flights 60 --seed 1".
CAMPAIGN ?=

campaign: $(STAMPS)/rust $(STAMPS)/python-module ## Fly 300 healthy flights, then 300 at the edges of the envelope, and say what failed (CAMPAIGN=)
	@mkdir -p target $(RESULTS)
	$(PYTHON) -m fcc_hil campaign --healthy --seed 200000 --json target/healthy.json --results $(RESULTS)/healthy.md $(CAMPAIGN)
	$(PYTHON) -m fcc_hil campaign --seed 200000 --json target/campaign.json --picture target/campaign.png $(CAMPAIGN)

bench-live: $(STAMPS)/rust build $(STAMPS)/python ## Fly with and without 1,000 watchers, alternately (50 minutes)
	cargo build --locked --release -p fcc-live --features flight --example watch
	$(PYTHON) -m fcc_hil bench-live --fccd $(FCCD) --watcher $(TARGET)/release/examples/watch $(LIVE)

# For bench-ground, such as MEASURE="--only soak --soak-minutes 480".
MEASURE ?=

bench-ground: build station $(STAMPS)/python $(STAMPS)/browser ## Measure the ground station and its page; soak it (50 minutes; MEASURE=)
	@mkdir -p $(RESULTS)
	PYTHONPATH=web/tests:hil/tests $(PYTHON) web/tests/measure.py --fccd $(FCCD) \
	    --station $(TARGET)/release/fcc-ground --results $(RESULTS)/ground.md $(MEASURE)

bench-flood: build $(STAMPS)/python ## Fly among 100,000 datagrams a second of another host (1 minute)
	$(call result,timing,'Among datagrams of others') $(PYTHON) -m fcc_hil bench-flood --fccd $(FCCD)

book: build ## Build the documents as a book with search: target/book/html
	@command -v mdbook >/dev/null || cargo install --locked --version 0.5.4 mdbook
	./scripts/book target/book
	./scripts/reference $(FCCD) target/book/src/reference
	mdbook build target/book
	./scripts/book --check target/book/html

doc: $(STAMPS)/rust ## Build the API documentation
	cargo doc --locked --workspace --no-deps --all-features

# Crates that are not published: the Python module is published as a wheel.
PRIVATE := fake-libandroid fcc-android fcc-ground fcc-phone fcc-py pendulum servo-board-firmware thermostat bench-tick
# Where they are built from their packages. cargo takes a package of the same
# version for the same, so what an earlier run unpacked and built is removed.
PACKAGED := $(TARGET)/packaged

package-check: $(STAMPS)/rust $(STAMPS)/python ## Build every crate from its package, and check both Python packages (10 minutes)
	rm -rf $(PACKAGED)/package $(PACKAGED)/debug/.fingerprint/fcc-* \
	    $${CARGO_HOME:-$$HOME/.cargo}/registry/src/-*/fcc-*
	cargo package --locked --allow-dirty --target-dir $(PACKAGED) --workspace \
	    $(addprefix --exclude ,$(PRIVATE))
	@for crate in $(PACKAGED)/package/*.crate; do \
	    test "$$(tar tzf $$crate | grep -c '/LICENSE-')" = 2 || { echo "$$crate lacks a licence"; exit 1; }; \
	done
	$(PYTHON) -m pip install --quiet --require-hashes -r hil/locked-packaging.txt
	rm -rf $(TARGET)/package-check
	cd crates/fcc-py && $(abspath $(VENV))/bin/maturin build --locked --quiet --out $(abspath $(TARGET))/package-check
	$(PYTHON) -m build --no-isolation --outdir $(TARGET)/package-check hil
	$(PYTHON) -m twine check --strict $(TARGET)/package-check/*

wheels: $(STAMPS)/rust $(STAMPS)/wheel-tools ## Build the Python module's wheels for x86-64 and ARM, and try one
	./scripts/build-wheels $(abspath $(VENV))/bin $(WHEELS)
	./scripts/try-wheel $(WHEELS)

clean: ## Remove built files
	cargo clean
	rm -rf $(VENV) $(STAMPS)

# --- set-up ------------------------------------------------------------------

# rustup reads rust-toolchain.toml and fetches what is missing at first use.
$(STAMPS)/rust: rust-toolchain.toml scripts/check-rust
	@./scripts/check-rust
	@command -v cc >/dev/null || ./scripts/apt-install gcc libc6-dev
	@mkdir -p $(STAMPS) && touch $@

# Some 200 MB: a terminal shows the progress.
QUIET := $(shell test -t 2 || echo --quiet)

$(STAMPS)/python: hil/pyproject.toml hil/locked.txt
	@python3 -c 'import ensurepip, venv' 2>/dev/null || ./scripts/apt-install python3-venv
	python3 -m venv $(VENV)
	$(PYTHON) -m pip install $(QUIET) --require-hashes -r hil/locked.txt
	$(PYTHON) -m pip install --quiet --no-deps --no-build-isolation --editable ./hil
	@mkdir -p $(STAMPS) && touch $@

# The page of the ground station, which is put into its program.
PAGE := $(shell find web \( -name node_modules -o -name dist -o -name tests -o -name pictures \) -prune -o -type f -print)

$(STAMPS)/page: $(PAGE)
	@command -v npm >/dev/null || ./scripts/apt-install nodejs npm
	cd web && npm ci --no-audit --no-fund && npm run build
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/playwright: $(STAMPS)/python web/tests/locked.txt
	$(PYTHON) -m pip install $(QUIET) --require-hashes -r web/tests/locked.txt
	@touch $@

# Debian's browser: that of Playwright is another one.
$(STAMPS)/browser: $(STAMPS)/playwright
	@command -v chromium >/dev/null || ./scripts/apt-install chromium
	@touch $@

# node-mavlink, which decodes what we send.
$(STAMPS)/node: hil/node/package-lock.json
	@command -v npm >/dev/null || ./scripts/apt-install nodejs npm
	cd hil/node && npm ci --no-audit --no-fund --ignore-scripts
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/strace:
	@command -v strace >/dev/null || ./scripts/apt-install strace
	@mkdir -p $(STAMPS) && touch $@

# gpsfake, which plays a receiver to a real gpsd, is in gpsd-clients.
$(STAMPS)/gpsd:
	@command -v gpsfake >/dev/null && test -x /usr/sbin/gpsd || ./scripts/apt-install gpsd gpsd-clients
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/wheel-tools: $(STAMPS)/python
	@command -v aarch64-linux-gnu-gcc >/dev/null || ./scripts/apt-install gcc-aarch64-linux-gnu libc6-dev-arm64-cross
	$(PYTHON) -m pip install --quiet --require-hashes -r hil/locked-packaging.txt
	@touch $@

$(STAMPS)/valgrind:
	@command -v valgrind >/dev/null || ./scripts/apt-install valgrind
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/rt-tests:
	@command -v cyclictest >/dev/null || ./scripts/apt-install rt-tests
	@command -v stress-ng >/dev/null || ./scripts/apt-install stress-ng
	@command -v chrt >/dev/null && command -v taskset >/dev/null || ./scripts/apt-install util-linux
	@command -v python3 >/dev/null || ./scripts/apt-install python3
	@mkdir -p $(STAMPS) target && touch $@

$(STAMPS)/systemd:
	@command -v systemd-analyze >/dev/null || ./scripts/apt-install systemd
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/cross: $(STAMPS)/rust
	@command -v aarch64-linux-gnu-gcc >/dev/null && command -v arm-linux-gnueabihf-gcc >/dev/null || \
	    ./scripts/apt-install gcc-aarch64-linux-gnu libc6-dev-arm64-cross \
	        gcc-arm-linux-gnueabihf libc6-dev-armhf-cross
	rustup target add $(BOARDS) $(MICROCONTROLLERS)
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/java:
	@command -v javac >/dev/null && command -v mvn >/dev/null || ./scripts/apt-install openjdk-17-jdk-headless maven
	@mkdir -p $(STAMPS) && touch $@

# Compile the app's resources, and align its package.
$(STAMPS)/aapt:
	@command -v aapt2 >/dev/null && command -v zipalign >/dev/null || ./scripts/apt-install aapt zipalign
	@mkdir -p $(STAMPS) && touch $@

# C of libraries is compiled with the headers of the cross compilers.
$(STAMPS)/android: $(STAMPS)/cross
	@command -v clang-19 >/dev/null && command -v ld.lld-19 >/dev/null && command -v llvm-nm-19 >/dev/null || \
	    ./scripts/apt-install clang-19 lld-19 llvm-19
	rustup target add aarch64-linux-android armv7-linux-androideabi
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/qemu:
	@command -v qemu-aarch64 >/dev/null && command -v qemu-arm >/dev/null || \
	    ./scripts/apt-install qemu-user
	@mkdir -p $(STAMPS) && touch $@

$(STAMPS)/vm:
	@command -v qemu-system-x86_64 >/dev/null && command -v mmdebstrap >/dev/null && \
	    command -v fakeroot >/dev/null && command -v newuidmap >/dev/null || \
	    ./scripts/apt-install qemu-system-x86 mmdebstrap fakeroot uidmap e2fsprogs
	@mkdir -p $(STAMPS) && touch $@

# The modules `fcc` and `pendulum` are built anew whenever their sources changed: cargo knows.
.PHONY: $(STAMPS)/python-module
# `fcc` with the conformance suites, which its tests run; `pendulum` is an example, which
# nobody measures.
MATURIN := VIRTUAL_ENV=$(abspath $(VENV)) $(abspath $(VENV))/bin/maturin develop --quiet
$(STAMPS)/python-module: $(STAMPS)/python
	cd crates/fcc-py && $(MATURIN) --release --features conformance,pyo3/extension-module
	cd examples/pendulum && $(MATURIN)

# All that tests in Python run, by one call of cargo: their features unify, and each crate is
# compiled once. The faults do nothing unless a test sets them by the environment.
# `pendulum` alone: it is to have no aircraft.
tested: $(STAMPS)/rust $(STAMPS)/page $(STAMPS)/python
	cargo build --locked --profile ci -p fcc-daemon -p fcc-ground -p thermostat -p fcc-py \
	    --lib --bins --features fcc-daemon/fault-injection,fcc-py/conformance,pyo3/extension-module
	cargo build --locked --profile ci -p fcc-multicopter --example lockstep
	cargo build --locked -p pendulum --lib --features pyo3/extension-module
	./scripts/install-module $(VENV) $(TESTED)/libfcc.so fcc crates/fcc-py/fcc.pyi
	./scripts/install-module $(VENV) $(TARGET)/debug/libpendulum.so pendulum
