"""Decoders of EXT_meshopt_compression and KHR_meshopt_compression, in plain numpy.

`views` decodes a buffer view, by `attributes`, `triangles` and `filters`. Only decoding: rigtri writes what
it changes uncompressed, and keeps the rest as it is.
"""
