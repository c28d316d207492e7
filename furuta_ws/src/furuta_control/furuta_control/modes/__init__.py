"""Controller modes: one file per mode, :mod:`furuta_control.control` chooses between them."""
