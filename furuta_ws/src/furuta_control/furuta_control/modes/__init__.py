"""Controller modes: one file per mode; :mod:`furuta_control.control` lists them."""
