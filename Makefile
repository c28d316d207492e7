.PHONY: demo test test-all bench docs page wheel course soak clean

demo:
	./furuta demo

# make test is what every push runs; make test-all, before a release, adds the long tests. The fast tests
# of functions come first. Real-time tests run last and alone.
test: SHORT = and not long
PYTEST = tools/in_environment python -m pytest furuta_ws/tests
test test-all:
	tools/in_environment python -m pip install --disable-pip-version-check --quiet --no-deps \
		--requirement firmware/requirements.lock \
		--requirement furuta_ws/tests/requirements.lock
	$(PYTEST) -m "not realtime $(SHORT)" \
		--numprocesses auto --dist loadfile --no-loadscope-reorder
	$(PYTEST) -m "realtime $(SHORT)"

bench:
	tools/in_environment python -m pip install --disable-pip-version-check --quiet \
		--requirement benchmarks/requirements.lock
	tools/in_environment python benchmarks/run.py

# The documentation site in output/site, with its tools in an environment of their own. CHECK=1 also
# runs every command of every page in a clone; report in output/commands.md.
SITE = output/site_environment/bin/python
docs: page
	tools/in_environment python -m venv output/site_environment
	$(SITE) -m pip install --disable-pip-version-check --quiet --requirement docs/requirements.lock
	tools/in_environment python docs/site/reference_pages.py output/reference
	$(SITE) docs/site/build.py output/site output/reference output/furuta.html
	$(if $(CHECK),tools/in_environment python docs/site/commands.py --out output/commands.md)

# The closed loop in one file for a browser; the site shows it in the tutorial.
page:
	tools/in_environment python -m pip install --disable-pip-version-check --quiet \
		--requirement firmware/requirements.lock
	tools/in_environment python docs/site/one_page.py output/furuta.html

# One wheel with the library and the command line, for Python without ROS.
wheel:
	tools/in_environment python -m pip wheel --disable-pip-version-check --quiet --no-deps \
		--no-build-isolation --wheel-dir output/wheel .
	@ls output/wheel/*.whl

# make course opens JupyterLab with the exercises; CHECK=1 runs all solutions instead.
course:
	tools/in_environment python -m pip install --disable-pip-version-check --quiet \
		--requirement course/requirements.lock
	tools/in_environment python course/notebooks.py $(if $(CHECK),check,write) output/course
	$(if $(CHECK),,tools/in_environment jupyter lab --notebook-dir output/course/exercises)

# make soak MINUTES=60 SEED=1; SLICE=messages:4 STEPS=17 repeats the first steps of a slice.
MINUTES ?= 10
SEED ?= 1
soak:
	cd furuta_ws/tests && ../../tools/in_environment python -m soak --minutes $(MINUTES) \
		--seed $(SEED) --out ../../output/soak $(if $(SLICE),--slice $(SLICE)) $(if $(STEPS),--steps $(STEPS))

clean:
	rm -rf .venv .setup.log .setup.lock furuta_ws/build furuta_ws/install furuta_ws/log
