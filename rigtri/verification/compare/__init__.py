"""How far two rigs look apart, over all poses: the number that rigtri prints and refuses by.

`expected_result` asks the two questions about the result of an edit: is the written file what the edit
expects it to be (`compare_written`), and how far is that, on purpose, from the source
(`declared_differences`). Both are measured by `compare`: `verify` moves the vertices of any two files,
`self_check` bounds them by boxes. It finds the `correspondence` of two rigs, chooses `probes`, and lets
`deviation` evaluate them in all poses; what has no pose is compared as facts (`scene_facts`, `attachments`).
Nothing here reads a file or knows a format.
"""
