"""``python -m soak``: run a soak for some minutes, or repeat one slice of it."""

from __future__ import annotations

import argparse
import faulthandler
import json
import sys
from pathlib import Path

from ros_domain import take_domain

from soak.record import Slice
from soak.scheduler import run_slice, run_soak

# Time [s] beyond its own after which a slice shows where it is; the scheduler waits longer.
PATIENCE = 30.0


def main() -> int:
    """Entry point; returns the exit status: 1 if an oracle is broken."""
    options = _options()
    options.out.mkdir(parents=True, exist_ok=True)
    if options.slice is None:
        return run_soak(options.minutes * 60.0, options.seed, options.out.resolve())
    campaign, _, number = options.slice.partition(":")
    part = Slice(campaign, int(number or 0), options.seed, options.minutes * 60.0, options.steps)
    # A slice that does not end shows where it is.
    faulthandler.dump_traceback_later(part.seconds + PATIENCE)
    domain = take_domain()
    record = run_slice(part)
    domain.close()
    faulthandler.cancel_dump_traceback_later()
    file = options.out / f"{part.campaign}-{part.number}.json"
    file.write_text(json.dumps(record.as_json(), indent=1))
    for each in record.failures:
        print(f"{each.oracle}, step {each.step}: {each.detail}")
    print(file)
    return int(bool(record.broken))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0, help="duration [min]")
    parser.add_argument("--seed", type=int, default=1, help="seed of all random choices")
    parser.add_argument("--out", type=Path, default=Path("soak"), help="directory of the report")
    parser.add_argument("--slice", help="repeat one slice, CAMPAIGN:NUMBER")
    parser.add_argument("--steps", type=int, help="end a slice after so many steps")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
