"""Rig drivers: one module, or one package, for each protocol, loaded by name."""

from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules

from furuta_hw.connection.rig_driver import RigDriver
from furuta_hw.errors import RigError
from furuta_hw.rigs.rig import Rig
from furuta_model.accepted_parts import accepted_part

# The class that a module of this package defines.
CLASS_NAME = "Driver"


def make_driver(port: str, rig: Rig) -> RigDriver:
    """Make the driver that the rig file names.

    Raises:
        RigError: It is no usable driver.
        ParameterError: It is a part of the user's own that this process does not accept.
    """
    return find_driver(rig.line.driver)(port, rig)


def find_driver(name: str) -> type[RigDriver]:
    """Find a driver class: that of a module of furuta_hw/drivers, or an accepted part."""
    if ":" in name:
        driver = accepted_part(name)
    else:
        known = sorted(module.name for module in iter_modules(__path__))
        if name not in known:
            raise RigError(
                f"no rig driver {name}; known are {', '.join(known)}, or one of own_parts"
            )
        try:
            driver = getattr(import_module(f"{__name__}.{name}"), CLASS_NAME, None)
        except ImportError as error:
            raise RigError(f"cannot import rig driver {name}: {error}") from None
    if not (isinstance(driver, type) and issubclass(driver, RigDriver)):
        raise RigError(f"rig driver {name}: this is not a subclass of RigDriver")
    if isabstract(driver):
        missing = ", ".join(sorted(driver.__abstractmethods__))
        raise RigError(f"rig driver {name}: {driver.__name__} does not implement {missing}")
    return driver
