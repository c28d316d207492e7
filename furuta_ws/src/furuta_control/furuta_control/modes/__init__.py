"""Controller modes: one file per mode; :mod:`furuta_control.control` is the registry."""
