"""The page that ``rigtri view`` writes. page.js is made of the sources in viewer/, with three.js in it."""
