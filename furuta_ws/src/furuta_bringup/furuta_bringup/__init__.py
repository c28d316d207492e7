"""The whole graph: composed or launched, recorded, demonstrated, driven from the command line."""
