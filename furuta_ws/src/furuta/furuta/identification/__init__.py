"""Models from recordings.

A recording passes the folders in this order: `preparation` brings it to one set of units, signs and
zeros, `regression` finds a first model, `fitting` improves it by simulation along the recording
(`shooting`), `uncertainty` gives its standard errors, and `result` judges, reports and writes it.
:mod:`.identify` calls them.
"""
