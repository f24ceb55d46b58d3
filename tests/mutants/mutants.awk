# Lists the mutants of flexbeam_impl.h, one change each, in an order that the seed draws and that an edit elsewhere leaves as it
# is: by a hash of function, line and change. awk -v seed=1 -f mutants.awk flexbeam_impl.h; fields separated by tabs: hash, kind,
# section, function, line, occurrence of that change in its function, the line changed.
# Sections 3 to 13; code alone: no comments, no checks of arguments, no refusals, no declarations of types.
# Kinds: sign, operator (* / && || sin cos), factor (a constant), index (a constant or a letter), bound (of a loop by one pass,
# of a comparison with or without equality, of real numbers, which are never equal, the other way round; not where the equal ones
# are what is chosen from), term (of a sum, or a statement that adds or calls).

function hash(text, i, h) {
  h = 12345
  for (i = 1; i <= length(text); i++) {
    h = (h * h + 7919 * index(letters, substr(text, i, 1)) + 1) % 67108859
  }
  return h
}

# The code of a line: comments become blanks, so that places stay.
function code_of(line, out, i) {
  out = ""
  for (i = 1; i <= length(line); i++) {
    if (!in_comment && substr(line, i, 2) == "/*") {
      in_comment = 1
    }
    out = out (in_comment ? " " : substr(line, i, 1))
    if (in_comment && i > 1 && substr(line, i - 1, 2) == "*/") {
      in_comment = 0
    }
  }
  sub(/ +$/, "", out)
  return out
}

# Lines from which no mutant comes: refusals with their conditions, states of a call, sizes, declarations.
function leave_out(n, first, k) {
  if (code[n] ~ /FBI_REQUIRE|FB_ASSERT/) {
    for (k = n; k < lines && code[k] !~ /;$/; k++) {
      left[k] = 1
    }
    left[k] = 1
  }
  if (code[n] ~ /FB_ERR_|status|sizeof|\(void\)|typedef|case |^#|FBI_UNROLL/) {
    left[n] = 1
  }
  if (code[n] ~ /(return|status =).*FB_ERR_/ && code[n - 1] ~ /\{$/) { # the condition of a refusal
    for (first = n - 1; first > 0 && code[first] !~ /^ *(\} else )?(if|for|while) \(/ && n - first < 9; first--) {
    }
    for (k = first; k < n; k++) {
      left[k] = 1
    }
  }
}

function change(n, kind, at, old, new, line, key) {
  line = substr(raw[n], 1, at - 1) new substr(raw[n], at + length(old))
  key = name "|" raw[n] "|" line
  gsub(/ +/, " ", key)
  seen[key]++
  printf "%08d\t%s\t%s\t%s\t%d\t%d\t%s\n", hash(seed "|" key "|" seen[key] "|" seed), kind, section, name, n, seen[key], line
}

# End of the term that begins at `at`, 0 if it goes on in the next line.
function term_end(text, at, depth, c) {
  for (depth = 0; at <= length(text); at++) {
    c = substr(text, at, 1)
    if (c ~ /[(\[]/) {
      depth++
    }
    if (c ~ /[)\]]/ && --depth < 0 || depth == 0 && (c ~ /[,;}]/ || substr(text, at) ~ /^ ([-+?:<>]|[<>=!]=|&&|\|\|) /)) {
      return at
    }
  }
  return 0
}

# Notes the names that a line of a function declares as real numbers, in its signature or its body.
function note_reals(text, part, n, k) {
  while (gsub(/\([^()]*\)|\{[^{}]*\}/, "", text) && text !~ /fbi?_[a-z0-9_]+\(/) {
  }
  n = split(text, part, ",")
  for (k = 1; k <= n; k++) {
    if (part[k] ~ /fb_real/ || k > 1 && text ~ /^ +(static )?(const )?fb_real /) {
      gsub(/^.*fb_real|const|[* ]|[\[=)].*$|;$/, "", part[k])
      real[part[k]] = 1
    }
  }
}

# The sides of the comparison by `op` at a place of a line.
function left_of(text, at) {
  text = substr(text, 1, at - 1)
  sub(/^.*[ (!]/, "", text)
  sub(/^.*\[/, text ~ /\]$/ ? "&" : "", text) # of an index
  return text
}

function right_of(text, at, op) {
  text = substr(text, at + length(op))
  sub(/[ ;)].*$/, "", text)
  sub(/^[^[]*\]/, substr(text, 1, index(text, "]") - 1), text)
  return text
}

# Is one of them a real number, by its declaration?
function is_real(text, at, op, a, b) {
  a = left_of(text, at)
  b = right_of(text, at, op)
  sub(/[\[].*$/, "", a)
  sub(/[\[].*$/, "", b)
  return text ~ /FB_/ || a in real || b in real
}

# a < b ? a : b: the same with equality
function is_choice(text, at, op, a, b, rest) {
  a = left_of(text, at)
  b = right_of(text, at, op)
  rest = substr(text, at + length(op))
  return index(rest, b " ? " a " : " b ";") == 1 || index(rest, b " ? " b " : " a ";") == 1
}

function mutate(n, text, i, c, brackets, rest, end, words, is_for, stride, value) {
  text = code[n]
  is_for = text ~ /^ *for \(/
  stride = match(text, / \+= [0-9]+\)/) ? substr(text, RSTART + 4, RLENGTH - 5) : 1 # of such a loop
  brackets = 0
  for (i = 1; i <= length(text); i++) {
    c = substr(text, i, 1)
    rest = substr(text, i)
    brackets += (c == "[") - (c == "]")
    if (rest ~ /^ [-+] [^ ]/ && !brackets) {
      change(n, "sign", i, substr(rest, 1, 3), c2(rest) == "+" ? " - " : " + ")
      end = term_end(text, i + 3)
      if (end) {
        change(n, "term", i, substr(text, i, end - i), "")
      }
    } else if (rest ~ /^ [-+]= /) {
      change(n, "sign", i, substr(rest, 1, 4), c2(rest) == "+" ? " -= " : " += ")
    } else if (rest ~ /^[(=,?:] ?-[A-Za-z(]/ || rest ~ /^return -/) {
      change(n, "sign", i + index(rest, "-") - 1, "-", "")
    }
    if (rest ~ /^ [*\/] [^ ]/ && !brackets && !is_for && substr(text, i - 2, 2) !~ /[ (][0-9]/) {
      change(n, "operator", i, substr(rest, 1, 3), c2(rest) == "*" ? " / " : " * ")
    } else if (rest ~ /^ (&&|\|\|) /) {
      change(n, "operator", i, substr(rest, 1, 4), c2(rest) == "&" ? " || " : " && ")
    } else if (rest ~ /^FB_(SIN|COS)\(/) {
      change(n, "operator", i, substr(rest, 1, 6), substr(rest, 4, 3) == "SIN" ? "FB_COS" : "FB_SIN")
    }
    if (rest ~ /^FB_R\([0-9.e-]+\)/) {
      words = substr(rest, 6, index(rest, ")") - 6)
      value = words + 0
      change(n, "factor", i + 5, words, value == 0 ? "1.0" : "2 * " words)
    }
    if ((brackets || rest ~ /^[0-9] \* [a-z]/) && rest ~ /^[0-9]+/ && substr(text, i - 1, 1) ~ /[ (\[]/) {
      match(rest, /^[0-9]+/)
      words = substr(rest, 1, RLENGTH)
      change(n, "index", i, words, words == "0" ? "1" : words - 1 "")
    } else if (brackets && rest ~ /^[ij][^A-Za-z0-9_]/ && substr(text, i - 1, 1) ~ /[ (\[]/ &&
               text ~ (c == "i" ? "[^a-z_]j[^a-z_]" : "[^a-z_]i[^a-z_]")) {
      change(n, "index", i, c, c == "i" ? "j" : "i")
    }
    if (rest ~ /^ [<>]=? / && !is_for) {
      words = substr(rest, 1, index(substr(rest, 2), " ") + 1)
      if (is_real(text, i, words)) {
        change(n, "bound", i, words, c2(rest) == "<" ? " > " : " < ")
      } else if (!is_choice(text, i, words)) {
        change(n, "bound", i, words, " " c2(rest) (words ~ /=/ ? " " : "= "))
      }
    } else if (rest ~ /^ [<>]=? [^;]*;/ && is_for) {
      end = index(rest, ";")
      if (substr(rest, 1, end - 1) !~ / && /) {
        change(n, "bound", i, substr(rest, 1, end - 1), substr(rest, 1, end - 1) (c2(rest) == "<" ? " - " : " + ") stride)
      }
    } else if (rest ~ /^ [=!]= /) {
      change(n, "bound", i, substr(rest, 1, 4), c2(rest) == "=" ? " != " : " == ")
    } else if (is_for && rest ~ /^ = 0;/) {
      change(n, "bound", i, " = 0;", " = 1;")
    }
  }
  if (text ~ /^ +fbi?_[A-Za-z0-9_]+\(.*\);$/ || text ~ /^ +[^ ]+ [-+*]= .*;$/) {
    if (code[n - 1] ~ /[;{}]$/ || code[n - 1] == "") {
      match(text, /^ +/)
      change(n, "term", RLENGTH + 1, substr(text, RLENGTH + 1), ";")
    }
  }
}

function c2(text) {
  return substr(text, 2, 1)
}

BEGIN {
  checks = "_check$|_is_(finite|choice|attitude|end|symmetric6|inertia|excluded)$" # of arguments
  letters = " !\"#$%&'()*+,-./0123456789:;<=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_`abcdefghijklmnopqrstuvwxyz{|}~"
}

{
  raw[NR] = $0
  code[NR] = code_of($0)
  lines = NR
}

END {
  for (n = 1; n <= lines; n++) {
    leave_out(n)
  }
  number = 0
  for (n = 1; n <= lines; n++) {
    if (raw[n] ~ /^   [A-Z]+ >>[a-z]+/) {
      match(raw[n], />>[a-z0-9]+/)
      section = substr(raw[n], RSTART + 2, RLENGTH - 2)
      number = section !~ /^(config|status|version)$/
    }
    if (code[n] ~ /^[A-Za-z].*[A-Za-z0-9_]\(/ && match(code[n], /fbi?_[A-Za-z0-9_]+\(/)) {
      name = substr(code[n], RSTART, RLENGTH - 1)
      delete real
    }
    if (code[n] ~ /fb_real/) {
      note_reals(code[n])
    }
    inside = code[n] ~ /^\{/ ? 1 : code[n] ~ /^\}/ ? 0 : inside
    if (inside && number && !left[n] && name !~ checks) {
      mutate(n)
    }
  }
}
