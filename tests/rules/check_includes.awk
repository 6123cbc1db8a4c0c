# SPDX-License-Identifier: MIT
# First file: includes.rules. The others: sources, named from the root of the tree.

function trim(text) { gsub(/^[ \t]+|[ \t]+$/, "", text); return text }

function is_below(path, folder) { return path == folder || index(path, folder "/") == 1 }

# True if `word` stands in the space-separated `list`.
function has_word(list, word) { return index(" " list " ", " " word " ") > 0 }

function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }

# The rule whose folder is the longest that holds the file.
function rule_of(path,   rule, best) {
  best = ""
  for (rule in ours) if (is_below(path, rule) && length(rule) > length(best)) best = rule
  return best
}

# "std" for the C++ library, else the name of the package; "" if nobody knows the header.
function package_of(header,   key) {
  if (header in package_exact) return package_exact[header]
  for (key in package_start) if (index(header, key) == 1) return package_start[key]
  if (header !~ /[.\/]/) return "std"
  return ""
}

function breach(message) {
  printf "%s:%d: %s\n", FILENAME, FNR, message
  breaches++
}

function ours_allowed(header, list,   words, count, i, allowed) {
  count = split(list, words, " ")
  allowed = 0
  for (i = 1; i <= count; i++) if (substr(words[i], 1, 1) != "!" && is_below(header, words[i])) allowed = 1
  for (i = 1; i <= count; i++) {
    if (substr(words[i], 1, 1) == "!" && is_below(header, substr(words[i], 2))) allowed = 0
  }
  return allowed
}

# A header of another folder of tools must belong to that folder's public face, if it has declared one.
function check_public_face(header,   folder, face) {
  folder = folder_of(header)
  if (!is_below(FILENAME, "tools") || !(folder in public_face) || is_below(FILENAME, folder)) return
  face = header
  sub(/^.*\//, "", face)
  if (!has_word(public_face[folder], face)) {
    breach(header " is internal to " folder " (its face: " trim(public_face[folder]) ")")
  }
}

# A file of the tree, one that CMake makes from a template beside it, or, among the tests, one that their
# CMakeLists.txt names a folder for.
function is_our_file(header) {
  return is_readable(header) || is_readable(header ".in") || (is_below(FILENAME, "tests") && header !~ /\//)
}

function is_readable(path,   line, status) {
  status = (getline line < path)
  if (status >= 0) close(path)
  return status >= 0
}

function check_ours(header) {
  if (!is_our_file(header)) {
    breach("\"" header "\" is not a file of the tree (paths start at the root)")
    return
  }
  if (header !~ /\//) return
  if (!ours_allowed(header, ours[rule])) breach(rule " must not include " header)
  else check_public_face(header)
}

function check_package(header,   package) {
  package = package_of(header)
  if (package == "") { breach("<" header "> belongs to no package of includes.rules"); return }
  if (has_word(anywhere[rule], package)) return
  if (has_word(source_only[rule], package)) {
    if (FILENAME !~ /\.(cpp|c)$/) breach("<" header "> (" package ") belongs into a .cpp of " rule)
    return
  }
  breach(rule " must not include <" header "> (" package ")")
}

FNR == 1 { file_number++; if (file_number > 1) { rule = rule_of(FILENAME); if (rule == "") breach("no rule for this folder") } }

file_number == 1 {
  if ($0 ~ /^[ \t]*(#|$)/) next
  if ($1 == "package") {
    for (i = 3; i <= NF; i++) {
      if ($i ~ /\*$/) package_start[substr($i, 1, length($i) - 1)] = $2
      else package_exact[$i] = $2
    }
  } else if ($1 == "public") {
    for (i = 3; i <= NF; i++) public_face[$2] = public_face[$2] " " $i
  } else {
    if (split($0, field, "|") != 4) { breach("a rule has four columns"); next }
    name = trim(field[1])
    ours[name] = trim(field[2])
    anywhere[name] = trim(field[3])
    source_only[name] = trim(field[4])
  }
  next
}

/^[ \t]*#[ \t]*include[ \t]*</ {
  match($0, /<[^>]*>/)
  include_count++
  if (rule != "") check_package(substr($0, RSTART + 1, RLENGTH - 2))
}

/^[ \t]*#[ \t]*include[ \t]*"/ {
  match($0, /"[^"]*"/)
  include_count++
  if (rule != "") check_ours(substr($0, RSTART + 1, RLENGTH - 2))
}

END {
  if (breaches > 0) { printf "%d breaches of the include rules\n", breaches; exit 1 }
  printf "%d includes keep the rules\n", include_count
}
