#!/usr/bin/env bash
# Checks that the relative links of all Markdown pages lead to files, and their #anchors to headings.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

# The text of a page without its code, in which [...](...) is no link.
prose() { awk '/^ *```/ { code = !code; next } !code' "$1" | sed "s/\`[^\`]*\`//g"; }

# The anchors that GitHub gives the headings of a page.
anchors() {
  awk '/^ *```/ { code = !code; next } !code && /^#+ /' "$1" |
    sed -E 's/^#+ +//; s/[^[:alnum:] _-]//g; s/ /-/g' | tr '[:upper:]' '[:lower:]'
}

status=0
fail() {
  echo "$1 links to $2, $3" >&2
  status=1
}

mapfile -t pages < <(find . \( -path ./build -o -path ./out -o -path ./.git \) -prune -o \
  -name '*.md' -printf '%P\n' | sort)
for page in "${pages[@]}"; do
  while IFS= read -r link; do
    path=${link%%#*}
    target=$page
    [[ -z $path ]] || target=$(dirname "$page")/$path
    # Results of an experiment's full run may be missing while none has been published.
    if [[ $page == experiments/* && $path == results/* && ! -d ${target%%/results/*}/results ]]; then
      continue
    fi
    if [[ ! -e $target ]]; then
      fail "$page" "$link" "which does not exist"
    elif [[ $link == *'#'* ]] && ! anchors "$target" | grep -qxF -- "${link#*#}"; then
      fail "$page" "$link" "but there is no such heading"
    fi
  done < <(prose "$page" | grep -oP '\]\(\K[^) ]+' | grep -vE '^[a-z]+:')
done
exit "$status"
