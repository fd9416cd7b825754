# Completion of pliant for Bash. It calls `pliant __complete WORD...`.

_pliant() {
  local word=${COMP_WORDS[COMP_CWORD]} lines line kind ending
  [[ $word == "=" ]] && word=
  COMPREPLY=()
  # Bash does not expand a tilde in COMP_WORDS, so do it here; nothing else is expanded.
  mapfile -t lines < <("${COMP_WORDS[0]/#\~/$HOME}" __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  read -r kind line <<<"${lines[0]}"
  case $kind in
    words)
      for line in "${lines[@]:1}"; do
        line=${line%%$'\t'*}
        [[ $line == "$word"* ]] && COMPREPLY+=("$line")
      done
      ;;
    folders)
      compopt -o filenames
      mapfile -t COMPREPLY < <(compgen -d -- "$word")
      ;;
    files)
      compopt -o filenames
      if [[ -z $line ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
        return
      fi
      mapfile -t COMPREPLY < <(compgen -d -- "$word")
      local file
      while IFS= read -r file; do
        for ending in $line; do
          [[ $file == *"$ending" && ! -d $file ]] && COMPREPLY+=("$file")
        done
      done < <(compgen -f -- "$word")
      ;;
  esac
}

complete -F _pliant pliant
