"""The options of each operation: one module and one frozen dataclass for each, under its name.

They import nothing heavy, so that the command line knows its options without numpy. An operation's function
stands in a module of `rigtri.operations`, which has its dataclass too.
"""
