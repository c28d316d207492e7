"""The command line ``furuta``."""
