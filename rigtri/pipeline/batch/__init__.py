"""Many files: which they are, where their outputs go, who works on them, and what is done already.

entries     the inputs that were named, and their outputs
targets     what would go wrong with the outputs, before anything is done
shards      the part of a batch that one machine does
contents    hashes of files
axes        what a skeleton and its axes are, in a few bytes
urls        files that are elsewhere
fetched     one file that is elsewhere, fetched, done and sent
work        one file, in the process that works on it
engine      who works on the files; here processes of this machine
cluster     the workers of a Dask cluster
on_worker   what they do
openjd      a batch as a job of a render farm
manifest    what was done, in a file that outlives any run
run         a run: what is left to do, done
summary     what manifests say
"""
