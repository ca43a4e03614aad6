#!/usr/bin/env bash
# Adds inputs to those that the fuzzer of a reader starts from: scripts/pack_corpus.sh READER FILE... writes
# fuzz/corpus/READER.tar, with what is in it and these files, each under the SHA-1 of its bytes unless its
# name is there already. The same inputs make the same archive, byte by byte.
set -euo pipefail
if (($# < 2)); then
  sed -n '2,4s/^# //p' "$0" >&2
  exit 2
fi

archive=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/fuzz/corpus/$1.tar
shift
inputs=$(mktemp -d)
trap 'rm -r "$inputs"' EXIT
if [[ -e $archive ]]; then tar -xf "$archive" -C "$inputs"; fi
for file; do
  [[ -e $inputs/$(basename "$file") ]] || cp -- "$file" "$inputs/$(sha1sum <"$file" | cut -d' ' -f1)"
done
(cd "$inputs" && find . -type f -printf '%P\0') | LC_ALL=C sort -z |
  tar -cf "$archive" -C "$inputs" --null -T - --format=ustar --mtime=@0 --owner=0 --group=0 --numeric-owner \
    --mode=0644
printf '%s: %d inputs\n' "$archive" "$(tar -tf "$archive" | wc -l)"
