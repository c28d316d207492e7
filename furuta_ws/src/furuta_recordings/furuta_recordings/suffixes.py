"""Suffixes of files of series, and of tables with a row per run; without numpy, for options."""

SUFFIXES = (".csv", ".parquet", ".mat", ".npz")
TABLE_SUFFIXES = (".csv", ".parquet")
