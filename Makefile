.PHONY: demo test test-all test-noble bench docs page page-tools wheel course soak lock clean

demo:
	./furuta demo

# make test is what every push runs; make test-all, before a release, adds the long tests. The fast tests
# of functions come first. Real-time tests run last and alone.
test: SHORT = and not long
TESTS = furuta_ws/tests
PYTEST = tools/in_environment python -m pytest $(TESTS)
test test-all: page-tools
	tools/in_environment tools/install $(TESTS)/requirements.lock
	tools/in_environment python -m furuta_bringup.warm_up
	$(PYTEST) -m "not realtime $(SHORT)" \
		--numprocesses auto --dist loadfile --no-loadscope-reorder
	$(PYTEST) -m "realtime $(SHORT)"

# With the library versions of Ubuntu 24.04 (noble), where ROS 2 Jazzy runs: the committed state in a clone
# with an environment of its own. NOBLE_PYTHON are candidates, its own Python first.
NOBLE = output/noble
NOBLE_TESTS = $(addprefix furuta_ws/tests/,\
	furuta_bringup furuta_control furuta_description furuta_hw furuta_model \
	furuta_recordings furuta_ros page workspace/test_dependencies.py \
	$(patsubst %,furuta/test_%.py,axis comparison_scores gym library limit_cycle own_functions proof \
		study_files tuning whole_files) \
	$(patsubst %,graph/test_%.py,accepted_parts lockstep node_matrix reset second_publishers) \
	$(patsubst %,processes/test_%.py,analysis_verbs axis_verb bag_verbs command_line compare \
		missing_packages sweep tune))
NOBLE_PYTHON = python3.12 $(wildcard $(HOME)/.pyenv/versions/3.12.*/bin/python3) python3.11 python3
test-noble:
	test -d $(NOBLE) || git clone --quiet --no-checkout . $(NOBLE)
	git -C $(NOBLE) fetch --quiet --force ../.. HEAD && git -C $(NOBLE) checkout --quiet --force FETCH_HEAD
	cd $(NOBLE) && export FURUTA_REQUIREMENTS=requirements.noble.lock FURUTA_PYTHON="$(NOBLE_PYTHON)" && \
		tools/in_environment python -m furuta_bringup.warm_up && \
		tools/in_environment python -m pytest $(NOBLE_TESTS) -m "not realtime and (noble or not long)" \
		--numprocesses auto --dist loadfile

bench:
	tools/in_environment tools/install benchmarks/requirements.lock $(TESTS)/requirements.lock
	tools/in_environment python benchmarks/run.py

# The documentation site in output/site, with its tools in an environment of their own. The site loads
# nothing from another host. CHECK=1 also runs every command of every page in a clone; report in
# output/commands.md.
SITE = output/site_environment/bin/python
docs: page
	$(if $(CHECK),tools/in_environment tools/install $(TESTS)/requirements.lock)
	tools/in_environment python -m venv output/site_environment
	$(SITE) -m pip install --disable-pip-version-check --quiet --requirement docs/requirements.lock
	rm -rf output/site
	tools/in_environment $(SITE) -m sphinx --conf-dir docs/site --doctree-dir output/doctrees \
		--fresh-env --quiet --fail-on-warning --keep-going . output/site
	! grep -rEl '<(script|img|iframe|link)[^>]*(src|href)="(https?:)?//|(url\(|@import ).?(https?:)?//' \
		--include=*.html --include=*.css output/site
	tools/in_environment python docs/site/links.py output/site
	$(if $(CHECK),tools/in_environment python docs/site/commands.py --out output/commands.md)

# The closed loop in one file for a browser; the site shows it in the tutorial.
page: page-tools
	tools/in_environment python docs/site/one_page.py output/furuta.html

# Compiler, Node.js, three.js and esbuild. Both npm packages are exact versions without dependencies.
PAGE = docs/site/page
page-tools:
	tools/in_environment tools/install firmware/requirements.lock $(PAGE)/requirements.lock
	mkdir -p output/page && cp $(PAGE)/package.json output/page
	tools/in_environment npm install --prefix output/page --no-package-lock --ignore-scripts --no-audit \
		--no-fund --silent

# One wheel with the library and the command line, for Python without ROS.
wheel:
	tools/in_environment python -m pip wheel --disable-pip-version-check --quiet --no-deps \
		--no-build-isolation --wheel-dir output/wheel .
	@ls output/wheel/*.whl

# make course opens JupyterLab with the exercises; CHECK=1 runs all solutions instead. Root, the user of
# most containers, must allow itself. The server listens on localhost only, and asks for a token.
course:
	tools/in_environment tools/install course/requirements.lock
	tools/in_environment python course/notebooks.py $(if $(CHECK),check,write) output/course
	$(if $(CHECK),,tools/in_environment jupyter lab --notebook-dir output/course/exercises \
		$(if $(filter 0,$(shell id -u)),--allow-root))

# Random events for nodes, rig and loops, for so many examples of each.
EXAMPLES ?= 50
soak:
	FURUTA_SOAK=$(EXAMPLES) $(PYTEST)/soak --timeout 0 $(if $(SEED),--hypothesis-seed=$(SEED))

# The lock files. A lowest version, which is noble's, is the version in noble's. Packages without
# one are not in its apt; pip serves them. matplotlib 3.6.3 has no wheel for Python 3.12, and pyarrow 26
# needs numpy 2.
COMPILE = tools/in_environment uv pip compile --quiet --universal --no-annotate --no-header \
	--no-emit-index-url
OURS = pyproject.toml requirements.in
LOCKED = benchmarks course examples firmware $(PAGE) $(TESTS)
lock:
	$(COMPILE) --python-version 3.10 --extra ros --extra view $(OURS) --output-file requirements.lock
	$(foreach folder,$(LOCKED),$(COMPILE) --python-version 3.10 --constraint requirements.lock \
		$(folder)/requirements.in --output-file $(folder)/requirements.lock;)
	$(COMPILE) --python-version 3.10 docs/requirements.in --output-file docs/requirements.lock
	grep --no-filename --only-matching -E '[a-z]+>=[0-9.]+' $(OURS) $(TESTS)/requirements.in \
		| sed -e 's/>=/==/' -e 's/^matplotlib.*/&;python_version<"3.12"/' \
			-e '$$a matplotlib==3.8.0;python_version>="3.12"' -e '$$a pyarrow<26' \
		| $(COMPILE) --python-version 3.11 --all-extras $(OURS) $(TESTS)/requirements.in --constraint - \
			--no-emit-package playwright --no-emit-package axe-playwright-python \
			--output-file requirements.noble.lock

clean:
	rm -rf .venv .setup.log .setup.lock furuta_ws/build furuta_ws/install furuta_ws/log
