# Of a generated step (code.h) the members of its structs, each beside that of the library's struct, which has the same name: tables
# for tests/checks/code.c.
function row(own, theirs, kind, part) {
  line[struct, rows[struct]++] = "  ROW(generated_" struct ", " own ", " theirs ", " kind ", " part "),"
}
# A member, at: of which body, or of the joint of which loop, which stand behind the bodies.
function member(name, at,    part, tree, load, theirs) {
  tree = at != ""
  part = at ~ /^loop/ ? "BODIES + " substr(at, 6) : tree ? substr(at, 6) : 0
  at = tree ? at "." : ""
  if (struct == "parameters") {
    row(name, "fb_body_factors, " name, "PLACE", 0)
  } else if (struct == "state") {
    theirs = name == "motor_work" ? "tree.motor_work" : name ~ /^hold/ ? "tree." name "[" part "]" : (tree ? "tree.link[" part "]." : "body.") name
    sub(/rotor_angle$/, "q", theirs)
    sub(/rotor_momentum$/, "pi", theirs)
    if (name !~ /^lost_rotor/) row(at name, "reference, " theirs, name ~ /^lost/ ? "LOST" : name ~ /^hold/ ? "VALUE" : kind[name], part)
  } else if (struct == "input") {
    load = name
    sub(/_1$/, "", load)
    theirs = name ~ /^pull/ ? "tree.pull[" substr(name, 6) "]" : name == "rotor_motor" ? (tree ? "tree.rotor[" part "]" : "body.rotor") \
      : name !~ /^(force|torque)/ ? (tree ? "tree.drive[" part "]." (name == "motor" ? "torque" : name) : "body." name) \
      : tree ? "tree.load[" part (name ~ /_1$/ ? " + BODIES" : "") "].load." load : "body.load[" (name ~ /_1$/) "]." load
    row(at name, "acts, " theirs, name == "rotor_motor" ? "MOTORS" : "ACTS", part)
  } else {
    theirs = name == "position" ? "pose[" part "].rho" : name == "R" ? "pose[" part "].quat" : name == "speed" ? "joint[" part "].speed" : "motion[" part "]." name
    row(at name, "sight, " (tree ? "tree." theirs : "body." name), name == "R" ? "ATTITUDE" : "PLACE", part)
  }
}
BEGIN {
  n = split("x PLACE rho PLACE quat ATTITUDE u FRAME p MOMENTUM L MOMENTUM q MODE pi MODE_MOMENTUM rotor_angle ANGLE rotor_momentum SPUN motor_work WORKED", word, " ")
  for (k = 1; k < n; k += 2) kind[word[k]] = word[k + 1]
}
/^typedef struct generated_(state|input|motion|parameters) / { struct = substr($3, 11); n = inner = 0; next }
struct == "" { next }
{ gsub(/\/\*[^*]*\*\//, "") }
/^  struct \{/ { inner = 1; next }
/^}/ { struct = ""; next }
/^  } / {
  sub(";", "", $2)
  for (k = 0; k < n; k++) member(held[k], $2)
  if (struct == "input" && $2 ~ /^body/) bodies = substr($2, 6) + 1
  n = inner = 0
  next
}
{
  gsub(/;|\[[0-9]*\]|double|float| /, "")
  count = split($0, names, ",")
  for (i = 1; i <= count; i++) {
    if (inner) held[n++] = names[i]
    else member(names[i], "")
  }
}
END {
  print "#define BODIES " bodies + 0
  if (rows["parameters"]) print "#define VARY"
  for (i = 0; i < rows["input"]; i++) if (line["input", i] ~ /body\.v_dot/) print "#define BASE_IS_PRESCRIBED"
  n = split("state input motion parameters", word, " ")
  for (k = 1; k <= n; k++) {
    if (rows[word[k]]) print "static const place " word[k] "_places[] = {"
    for (i = 0; i < rows[word[k]]; i++) print line[word[k], i]
    if (rows[word[k]]) print "};"
  }
}
