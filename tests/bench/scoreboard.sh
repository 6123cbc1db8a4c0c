#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs the benchmark behind every numeric target and prints what was measured beside what is asked.
# The rows stand in tests/bench/rows/*.row; tests/bench/rows/README.md says how to add one.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)

usage() {
  cat <<'TEXT'
Usage: tests/bench/scoreboard.sh [NAME…] [--json] [--list] [--strict]
  NAME…            rows whose name is NAME or begins with it (default: all)
  --json           the same as JSON on stdout
  --list           only the rows and their commands; runs nothing
  --strict         exit status 1 unless every row is green (or has no target)
  --rows DIR       folder of *.row files (default: tests/bench/rows)
  --build DIR      build folder (default: build/release; configured when missing)
  --no-build       take the programs as they are
  --timeout-s N    for each command (default 1800)
Data come from SOUPLE_DATA_DIR (default: ../shared/data). A row that falls short stays in the table.
TEXT
}

json=0
list=0
strict=0
build=1
timeout_s=1800
rows_dir=$here/rows
build_dir=$root/build/release
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --json) json=1 ;;
    --list) list=1 ;;
    --strict) strict=1 ;;
    --no-build) build=0 ;;
    --rows) rows_dir=${2:?--rows needs a folder}; shift ;;
    --build) build_dir=${2:?--build needs a folder}; shift ;;
    --timeout-s) timeout_s=${2:?--timeout-s needs a number}; shift ;;
    -h | --help) usage; exit 0 ;;
    -*) echo "unknown option: $1" >&2; usage >&2; exit 2 ;;
    *) names+=("$1") ;;
  esac
  shift
done
rows_dir=$(cd "$rows_dir" && pwd)
# One spelling of the build folder, whether it exists yet or not.
case "$build_dir" in /*) ;; *) build_dir=$PWD/$build_dir ;; esac

work=$(mktemp -d "${TMPDIR:-/tmp}/souple-scoreboard.XXXXXX")
trap 'rm -rf "$work"' EXIT
say() { printf 'scoreboard: %s\n' "$*" >&2; }

# Columns of the rows, by index.
row_name=() row_issue=() row_target=() row_comparison=() row_threshold=() row_unit=() row_command=()

trim() {
  local text=$1
  text=${text#"${text%%[![:space:]]*}"}
  printf '%s' "${text%"${text##*[![:space:]]}"}"
}

is_wanted() {
  local name
  if [ "${#names[@]}" -eq 0 ]; then return 0; fi
  for name in "${names[@]}"; do
    case "$1" in "$name"*) return 0 ;; esac
  done
  return 1
}

is_number() { [[ "$1" =~ ^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$ ]]; }

read_rows() {
  local file line name issue target comparison threshold unit command number
  for file in "$rows_dir"/*.row; do
    if [ ! -f "$file" ]; then continue; fi
    number=0
    while IFS= read -r line || [ -n "$line" ]; do
      number=$((number + 1))
      if [[ "$line" =~ ^[[:space:]]*(#|$) ]]; then continue; fi
      # The command is the last column and may hold bars of its own.
      IFS='|' read -r name issue target comparison threshold unit command <<<"$line"
      name=$(trim "$name")
      comparison=$(trim "$comparison")
      threshold=$(trim "$threshold")
      command=$(trim "${command-}")
      case "$comparison" in
        '<=' | '>=' | '<' | '>' | '==')
          is_number "$threshold" || { say "$file:$number: threshold '$threshold' is not a number"; exit 2; } ;;
        '-') ;;
        *) say "$file:$number: comparison '$comparison' is none of <= >= < > == -"; exit 2 ;;
      esac
      if [ -z "$name" ] || [ -z "$command" ]; then
        say "$file:$number: a row has 7 columns: name|issue|target|comparison|threshold|unit|command"
        exit 2
      fi
      if ! is_wanted "$name"; then continue; fi
      row_name+=("$name")
      row_issue+=("$(trim "$issue")")
      row_target+=("$(trim "$target")")
      row_comparison+=("$comparison")
      row_threshold+=("$threshold")
      row_unit+=("$(trim "$unit")")
      row_command+=("$command")
    done <"$file"
  done
}

# Builds a target once; prints the path of its program.
program_of() {
  local target=$1 path
  if [ "$build" -eq 1 ] && [ ! -e "$work/built-$target" ]; then
    if [ ! -f "$build_dir/build.ninja" ]; then
      (cd "$root" && cmake --preset release -B "$build_dir") >"$work/configure" 2>&1 ||
        { cat "$work/configure" >&2; return 1; }
    fi
    say "building $target"
    cmake --build "$build_dir" --target "$target" -j "$("$root/tools/build_jobs.sh")" >"$work/build" 2>&1 ||
      { tail -n 40 "$work/build" >&2; return 1; }
    touch "$work/built-$target"
  fi
  # Ninja knows a program in a folder by an alias of its target's name.
  path=$(ninja -C "$build_dir" -t query "$target" 2>/dev/null |
    awk 'NR == 2 {is_alias = $2 == "phony"} NR == 3 && is_alias {print $1}')
  path=$build_dir/${path:-$target}
  if [ ! -x "$path" ]; then say "$target: no program at $path"; return 1; fi
  printf '%s' "$path"
}

# The command with every @target@ replaced by the path of its program, quoted for the shell.
expand_command() {
  local command=$1 target path
  while [[ "$command" =~ @([A-Za-z_][A-Za-z0-9_]*)@ ]]; do
    target=${BASH_REMATCH[1]}
    path=$(program_of "$target") || return 1
    case "$path" in "$root"/*) path=${path#"$root"/} ;; esac
    command=${command//"@$target@"/"$(printf '%q' "$path")"}
  done
  printf '%s' "$command"
}

# Runs the command of row $1 unless an earlier row had the same; its output goes to output-<key>.
# Sets `key`.
run_command() {
  local command=${row_command[$1]} expanded status=0 started
  key=$(cksum <<<"$command" | tr ' ' '-')
  if [ -e "$work/status-$key" ]; then return; fi
  if ! expanded=$(expand_command "$command"); then
    echo "build failed" >"$work/status-$key"
    printf '%s' "$command" >"$work/command-$key"
    return
  fi
  printf '%s' "$expanded" >"$work/command-$key"
  say "running $expanded"
  started=$SECONDS
  mkdir -p "$work/scratch"
  (cd "$root" && BENCH_TMP="$work/scratch" SOUPLE_DATA_DIR="${SOUPLE_DATA_DIR:-$root/../shared/data}" \
    timeout --kill-after=10 "$timeout_s" bash -euo pipefail -c "$expanded") \
    >"$work/output-$key" 2>"$work/talk-$key" </dev/null || status=$?
  say "took $((SECONDS - started)) s"
  case "$status" in
    0) echo ok >"$work/status-$key" ;;
    124 | 137) echo "stopped after $timeout_s s" >"$work/status-$key" ;;
    *) echo "exit status $status" >"$work/status-$key" ;;
  esac
  if [ "$status" -ne 0 ]; then tail -n 10 "$work/talk-$key" >&2; fi
}

# What the output of the command says of row $1: value unit min max runs hash, "-" where nothing is said.
measurement_of() {
  if [ ! -f "$work/output-$key" ]; then return; fi
  awk -v wanted="${row_name[$1]}" '
    $1 == "row" && $2 == wanted {
      split("", found)
      for (i = 3; i <= NF; i++) {
        at = index($i, "=")
        if (at > 1) found[substr($i, 1, at - 1)] = substr($i, at + 1)
      }
      has_row = 1
    }
    function said(name) { return (name in found) && found[name] != "" ? found[name] : "-" }
    END {
      if (has_row) print said("value"), said("unit"), said("min"), said("max"), said("runs"), said("hash")
    }' "$work/output-$key"
}

verdict_of() {
  awk -v value="$1" -v comparison="$2" -v threshold="$3" 'BEGIN {
    value += 0; threshold += 0
    if (comparison == "<=") holds = value <= threshold
    else if (comparison == ">=") holds = value >= threshold
    else if (comparison == "<") holds = value < threshold
    else if (comparison == ">") holds = value > threshold
    else holds = value == threshold
    print holds ? "green" : "red" }'
}

json_text() {
  local text=$1
  text=${text//\\/\\\\}
  text=${text//\"/\\\"}
  text=${text//$'\t'/\\t}
  printf '"%s"' "$(tr -d '\000-\037' <<<"$text")"
}

json_number() { if is_number "$1"; then awk -v n="$1" 'BEGIN {printf "%.15g", n}'; else printf 'null'; fi; }

# Measures row $1 and sets value, unit, min, max, runs, hash, verdict, note.
measure() {
  local index=$1 status found
  run_command "$index"
  status=$(cat "$work/status-$key")
  found=$(measurement_of "$index")
  read -r value unit min max runs hash <<<"${found:-- - - - - -}"
  if [ "$unit" = - ] || [ -z "$unit" ]; then unit=${row_unit[$index]}; fi
  note=''
  if [ "$status" != ok ]; then
    verdict=error
    note=$status
  elif [ -z "$found" ]; then
    verdict=error
    note="the command printed no such row"
  elif ! is_number "$value"; then
    verdict=error
    note="value '$value' is not a finite number"
  elif [ "$unit" != "${row_unit[$index]}" ]; then
    verdict=error
    note="measured in $unit, the row is in ${row_unit[$index]}"
  elif [ "${row_comparison[$index]}" = - ]; then
    verdict=noted
  else
    verdict=$(verdict_of "$value" "${row_comparison[$index]}" "${row_threshold[$index]}")
  fi
}

# Four digits, but whole numbers in full.
short() {
  if is_number "$1"; then
    awk -v n="$1" 'BEGIN {if (n == int(n) && n < 1e15 && n > -1e15) printf "%.0f", n; else printf "%.4g", n}'
  else
    printf '%s' "$1"
  fi
}

table_line() {
  local index=$1 measured
  if [ "$verdict" = error ]; then
    measured=$note
  else
    measured="$(short "$value") $unit"
    if [ "$min" != - ] && [ "$max" != - ]; then
      measured+=" ($(short "$min")…$(short "$max")"
      if [ "$runs" != - ]; then measured+=", $runs runs"; fi
      measured+=")"
    fi
  fi
  printf '%s\t%s\t%s\t%s\t%s\t%s\n' "${row_name[$index]}" "${row_target[$index]}" "$measured" "$verdict" \
    "$hash" "$(cat "$work/command-$key")" >>"$work/table"
}

json_line() {
  local index=$1 hash_json=null
  if [ "$hash" != - ]; then hash_json=$(json_text "$hash"); fi
  {
    if [ "$json_separator" ]; then printf '%s\n' "$json_separator"; fi
    printf '    {"name": %s, "issue": %s, "target": %s, "comparison": %s, "threshold": %s, "unit": %s,\n' \
      "$(json_text "${row_name[$index]}")" "$(json_text "${row_issue[$index]}")" \
      "$(json_text "${row_target[$index]}")" "$(json_text "${row_comparison[$index]}")" \
      "$(json_number "${row_threshold[$index]}")" "$(json_text "${row_unit[$index]}")"
    printf '     "value": %s, "min": %s, "max": %s, "runs": %s, "hash": %s, "verdict": "%s", "note": %s,\n' \
      "$(json_number "$value")" "$(json_number "$min")" "$(json_number "$max")" "$(json_number "$runs")" \
      "$hash_json" "$verdict" "$(json_text "$note")"
    printf '     "command": %s}' "$(json_text "$(cat "$work/command-$key")")"
  } >>"$work/json"
  json_separator=,
}

# Columns as wide as their longest cell.
print_table() {
  local widths=(0 0 0 0 0) cells cell i length
  while IFS=$'\t' read -r -a cells; do
    for i in 0 1 2 3 4; do
      length=${#cells[i]}
      if [ "$length" -gt "${widths[i]}" ]; then widths[i]=$length; fi
    done
  done <"$work/table"
  while IFS=$'\t' read -r -a cells; do
    for i in 0 1 2 3 4; do
      cell=${cells[i]}
      printf '%s%*s  ' "$cell" $((widths[i] - ${#cell})) ''
    done
    printf '%s\n' "${cells[5]}"
  done <"$work/table"
}

machine_text() {
  local model
  model=$(awk -F': *' '/^model name/ {print $2; exit}' /proc/cpuinfo)
  printf '%s, %s processors, commit %s' "${model:-unknown processor}" "$(nproc)" \
    "$(git -C "$root" describe --always --dirty 2>/dev/null || echo unknown)"
}

read_rows
if [ "${#row_name[@]}" -eq 0 ]; then
  say "no row ${names[*]+of the names ${names[*]} }in $rows_dir"
  exit 2
fi
duplicate=$(printf '%s\n' "${row_name[@]}" | LC_ALL=C sort | uniq -d | head -n 1)
if [ -n "$duplicate" ]; then
  say "two rows are named $duplicate"
  exit 2
fi

if [ "$list" -eq 1 ]; then
  printf 'name\ttarget\tissue\tcomparison\tthreshold\tcommand\n' >"$work/table"
  for index in "${!row_name[@]}"; do
    printf '%s\t%s\t%s\t%s\t%s %s\t%s\n' "${row_name[$index]}" "${row_target[$index]}" "${row_issue[$index]}" \
      "${row_comparison[$index]}" "${row_threshold[$index]:--}" "${row_unit[$index]}" \
      "${row_command[$index]}" >>"$work/table"
  done
  print_table
  exit 0
fi

green=0 red=0 noted=0 error=0
: >"$work/json"
json_separator=
printf 'name\ttarget\tmeasured\tverdict\thash\tcommand\n' >"$work/table"
for index in "${!row_name[@]}"; do
  measure "$index"
  case "$verdict" in
    green) green=$((green + 1)) ;;
    red) red=$((red + 1)) ;;
    noted) noted=$((noted + 1)) ;;
    *) error=$((error + 1)) ;;
  esac
  table_line "$index"
  json_line "$index"
done

if [ "$json" -eq 1 ]; then
  printf '{\n  "schema": "souple-scoreboard", "version": 1, "machine": %s,\n' "$(json_text "$(machine_text)")"
  printf '  "counts": {"green": %d, "red": %d, "noted": %d, "error": %d},\n  "rows": [\n' \
    "$green" "$red" "$noted" "$error"
  cat "$work/json"
  printf '\n  ]\n}\n'
else
  machine_text
  printf '\n\n'
  print_table
  printf '\n%d green, %d red, %d without a target, %d errors\n' "$green" "$red" "$noted" "$error"
fi

if [ "$strict" -eq 1 ] && [ $((red + error)) -gt 0 ]; then exit 1; fi
