"""Many files: which they are, where their outputs go, who works on them, and what is done already.

inputs, job_files                   the files that were named, and their outputs
output_checks                       what would go wrong with the outputs, before anything is done
shards                              the part of a batch that one machine does
run                                 a run: what is left to do, done
manifest_writer, manifest_lookup    what was done, in a file that outlives any run
hashes                              hashes of files
axis_summary                        what a skeleton and its axes are, in a few bytes
report                              a summary of manifests
file_task, spec_task, convert_task  one file, in the process that works on it
local_engine                        processes of this machine
dask, dask_worker                   the workers of a Dask cluster, and what they run
openjd                              a batch as a job of a render farm
urls, remote_files                  files of other stores: their URLs, and one of them fetched, done and sent

What is done to a file is for `rigtri.pipeline.edit` and `rigspec`; nothing here looks into a file.
"""
