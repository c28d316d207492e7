"""The page in one file: what can be set, the translated loop, and how it is shown."""
