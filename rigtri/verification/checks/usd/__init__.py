"""The check of USD stages and packages, one module for each part of a stage.

`scene` collects the prims that matter, the other modules look at them; `usd_validation` adds what OpenUSD's
own validators find. Nothing here changes a layer.
"""
