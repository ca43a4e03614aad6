# Completion of `trilobe` in bash, from what its help says: `source scripts/trilobe.bash`, or installed by
# `cmake --install` where bash-completion looks.
# shellcheck shell=bash

_trilobe() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} trilobe=${COMP_WORDS[0]}
  local command=${COMP_WORDS[1]-} words=''
  # bash takes --solver=awls for three words, the second of which is =.
  if [[ $word == '=' ]]; then word='' before='='; fi
  if [[ $before == '=' ]]; then
    case ${COMP_WORDS[COMP_CWORD - 1]}${COMP_WORDS[COMP_CWORD - 2]} in
      *--solver*) words=$("$trilobe" solvers 2>/dev/null | sed -n 's/^\([a-z_]\{1,\}\).*/\1/p') ;;
      *--model*) words='shared isotropic anisotropic independent auto' ;;
    esac
    if [[ -z $words ]]; then
      mapfile -t COMPREPLY < <(compgen -f -- "$word")
      return
    fi
  elif ((COMP_CWORD == 1)) || { ((COMP_CWORD == 2)) && [[ $command == help ]]; }; then
    words=$("$trilobe" help 2>/dev/null | sed -n 's/^  \([a-z]\{1,\}\)  .*/\1/p')
  elif [[ $word == -* ]]; then
    words=$("$trilobe" help "$command" --all 2>/dev/null | sed -n 's/^  \(--[a-z_0-9]\{1,\}=\).*/\1/p')
    compopt -o nospace
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}

complete -F _trilobe trilobe
