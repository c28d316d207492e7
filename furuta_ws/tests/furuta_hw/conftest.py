"""The C firmware as machine code, for this computer and for Cortex-M processors."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

from furuta_hw.emulator.compiled_firmware import load_replay

if TYPE_CHECKING:
    from cortex_m import CortexM

Replay = Callable[[bytes], bytes]


@pytest.fixture(scope="session")
def zig() -> None:
    """The compiler; `make test` installs it."""
    pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")


@pytest.fixture(scope="session")
def cortex_m(zig: None, tmp_path_factory: pytest.TempPathFactory) -> dict[str, CortexM]:
    """The emulated processors by name."""
    pytest.importorskip("unicorn", reason="pip install -r firmware/requirements.lock")
    from cortex_m import PROCESSORS, CortexM

    directory = tmp_path_factory.mktemp("firmware")
    return {processor: CortexM(processor, directory) for processor in PROCESSORS}


@pytest.fixture(scope="session")
def replays(cortex_m: dict[str, CortexM]) -> dict[str, Replay]:
    """All machines by name, each as a function from script to log."""
    return {"host": load_replay()} | {name: machine.replay for name, machine in cortex_m.items()}
