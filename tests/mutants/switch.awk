# One flexbeam_impl.h with all mutants in it, to be compiled once: a function with mutants becomes a copy of each, the original
# as copy 0, and one that calls the copy which the environment chooses (switch.h).
# awk -v prelude=switch.h -f switch.awk LIST flexbeam_impl.h; LIST: number, line and text of the line, separated by tabs. A comment "mutant N" at
# the start of a line stands before each copy, so that an error of the compiler tells which mutant it is.

# Names of the arguments of a signature, as a call takes them.
function arguments(signature, list, n, part, i) {
  sub(/^[^(]*\(/, "", signature)
  sub(/\)[^)]*$/, "", signature)
  gsub(/\[[^]]*\]/, "", signature)
  if (signature == "void") {
    return ""
  }
  n = split(signature, part, ",")
  for (i = 1; i <= n; i++) {
    gsub(/[()*]/, " ", part[i]) # of a pointer to arrays: (*x)[N]
    match(part[i], /[A-Za-z0-9_]+ *$/)
    list = list (i > 1 ? ", " : "") substr(part[i], RSTART)
  }
  return list
}

# Lines first to last as copy number of the function; its body opens in line open.
function copy(number, n, text) {
  print "/* mutant " number " */"
  for (n = first; n <= last; n++) {
    text = number > 0 && n == line[number] ? mutant[number] : source[n]
    if (n < open) {
      sub(/^FB_DEF/, "static", text)
      sub(name "\\(", name "_mutant_" number "(", text)
    }
    print text
  }
}

function all_copies(signature, n, k, which) {
  for (n = first; n < open; n++) {
    signature = signature source[n]
  }
  match(signature, /fbi?_[A-Za-z0-9_]+\(/)
  name = substr(signature, RSTART, RLENGTH - 1)
  copy(0)
  for (n = open; n <= last; n++) {
    split(numbers[n], which, " ")
    for (k = 1; k in which; k++) {
      copy(which[k])
    }
  }
  print signature "\n{\n  fbi_reached[" functions++ "] = \"" name "\";\n  switch (fbi_mutant) {"
  for (n = open; n <= last; n++) {
    split(numbers[n], which, " ")
    for (k = 1; k in which; k++) {
      print "  case " which[k] ": return " name "_mutant_" which[k] "(" arguments(signature) ");"
    }
  }
  print "  default: return " name "_mutant_0(" arguments(signature) ");\n  }\n}"
}

FNR == NR {
  n = split($0, field, "\t")
  line[field[1]] = field[2]
  mutant[field[1]] = field[3]
  numbers[field[2]] = numbers[field[2]] " " field[1]
  next
}

{
  source[FNR] = $0
  lines = FNR
}

END {
  while ((getline text < prelude) > 0) {
    print text
  }
  for (n = 1; n <= lines; n++) {
    for (open = n; open < lines && source[n] ~ /^(FB_DEF|static) .*fbi?_[A-Za-z0-9_]+\(/ && source[open] !~ /^\{|;$/; open++) {
    }
    if (source[n] !~ /^(FB_DEF|static) / || source[open] !~ /^\{/) {
      print source[n]
      continue
    }
    first = n
    changed = 0
    for (last = open; source[last] !~ /^\}/; last++) {
      changed += last in numbers
    }
    if (changed) {
      all_copies()
      n = last
    } else {
      print source[n]
    }
  }
}
