# Completes the commands of octalux, their options, and the names of files behind them; the words come from the program.
_octalux() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} words
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="$(octalux help words 2>/dev/null) help"
  elif [ "$command" = export ] && [ "$COMP_CWORD" -eq 2 ]; then
    words="exr gltf ktx2 web"
  elif [ "$command" = help ]; then
    words="$(octalux help words 2>/dev/null)"
  elif [[ $word == -* ]]; then
    [ "$command" = export ] && command="export ${COMP_WORDS[2]}"
    # shellcheck disable=SC2086 # a command of two words
    words=$(octalux help $command words 2>/dev/null)
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o filenames -F _octalux octalux
