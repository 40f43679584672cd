"""The page that ``rigtri view`` writes.

`page_data` is what the page shows, as JSON; `view` puts it and the content of the files into page.html.
page.js is built from the sources in the folder viewer/, with three.js in it, and never edited here. What
is drawn of a rig comes from `rigtri.export.drawing`. Neither this package nor the page fetches anything.
"""
