# `trilobe fit SOURCE... --out=DIR` shared out: a rule a shard, then one for fits.csv and index.html.
#
#   snakemake --snakefile scripts/fit_batch.smk --cores 8 \
#       --config sources=FOLDER out=DIR shards=8 options="--plots"
#
# and on Slurm, from a folder that all nodes see, `--profile scripts/slurm` instead of `--cores 8`.
# sources: files, folders, synth:NAME; options: flags of fit; threads: of a shard; program: a trilobe.
import os
import shlex

SOURCES = shlex.split(str(config["sources"]))
OUT = str(config.get("out", "out/fits"))
SHARDS = int(config.get("shards", 4))
THREADS = int(config.get("threads", 1))
PROGRAM = str(config.get("program", "build/release/bin/trilobe"))
COMMAND = " ".join(map(shlex.quote, [
    PROGRAM, "fit", *SOURCES, f"--out={OUT}", *shlex.split(str(config.get("options") or ""))]))

STAMP = f"{OUT}/shards/{{i}}-of-{SHARDS}"
# Exit status 3: everything was tried, and some measurements failed; fits.csv says which and why.
TRIED = " || test $? -eq 3"

onstart:
    os.makedirs(f"{OUT}/shards", exist_ok=True)  # where jobs on a cluster have their logs

rule tables:
    input: expand(STAMP, i=range(1, SHARDS + 1))
    output: OUT + "/fits.csv", OUT + "/index.html"
    params: command=COMMAND, log=OUT + "/shards/tables.log"
    threads: THREADS
    shell: "{params.command} --threads={threads}" + TRIED

rule shard:
    input: PROGRAM, [source for source in SOURCES if not source.startswith("synth:")]
    output: touch(STAMP)
    params: command=COMMAND, log=STAMP + ".log"  # another command, other fits
    threads: THREADS
    shell: "{params.command} --threads={threads} --shard={wildcards.i}/" + str(SHARDS) + TRIED
