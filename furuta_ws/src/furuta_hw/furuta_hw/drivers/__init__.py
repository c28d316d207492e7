"""Rig drivers: one module, or one package, for each protocol, loaded by name."""

from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules

from furuta_hw.connection.rig_driver import RigDriver
from furuta_hw.errors import RigError
from furuta_hw.rigs.rig import Rig

# The class that a module of this package defines.
CLASS_NAME = "Driver"


def make_driver(port: str, rig: Rig) -> RigDriver:
    """Make the driver that the rig file names. Raises :class:`RigError`."""
    return find_driver(rig.line.driver)(port, rig)


def find_driver(name: str) -> type[RigDriver]:
    """Find a driver class: a module of furuta_hw/drivers, or ``package.module:Class``."""
    module_name, colon, class_name = name.partition(":")
    if not colon:
        known = sorted(module.name for module in iter_modules(__path__))
        if name not in known:
            raise RigError(
                f"no rig driver {name}; known are {', '.join(known)}, or give package.module:Class"
            )
        module_name, class_name = f"{__name__}.{name}", CLASS_NAME
    try:
        driver = getattr(import_module(module_name), class_name, None)
    except (ImportError, ValueError) as error:
        raise RigError(f"cannot import rig driver {name}: {error}") from None
    if not (isinstance(driver, type) and issubclass(driver, RigDriver)):
        raise RigError(f"rig driver {name}: {class_name} is not a subclass of RigDriver")
    if isabstract(driver):
        missing = ", ".join(sorted(driver.__abstractmethods__))
        raise RigError(f"rig driver {name}: {class_name} does not implement {missing}")
    return driver
