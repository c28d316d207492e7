.PHONY: demo test bench clean

demo:
	./furuta demo

test:
	tools/in_environment python -m pytest furuta_ws/tests -m "not realtime" --numprocesses auto
	tools/in_environment python -m pytest furuta_ws/tests -m realtime

bench:
	tools/in_environment python -m pip install --disable-pip-version-check --quiet \
		--requirement benchmarks/requirements.lock
	tools/in_environment python benchmarks/run.py

clean:
	rm -rf .venv .setup.log .setup.lock furuta_ws/build furuta_ws/install furuta_ws/log
