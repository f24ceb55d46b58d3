#!/bin/sh
# Blades and towers of OpenFAST: every key is taken, told or refused. Finite-element models through examples/tools/import.py, by matrices and by
# Nastran's files (tests/checks/import.py): mass, inertia, first moments and frequencies of flexbeam's bodies are those of the models and
# of closed forms, spinning ones stiffen as its own beams do; what is wrong is told. Matrices reduced by Craig and Bampton
# (tests/checks/import_reduced.py) keep frequencies and the compliance at their interfaces. Modal data without a mesh
# (tests/checks/import_modal.py) give the body of the same masses. Large models (tests/checks/import_size.py) have bounds of
# time and memory. Files damaged at random, others each day, are refused
# or read (tests/checks/import_hostile.py). pyNastran, SciPy and NumPy are fetched by .ci/fetch into build/venv_nastran (an older NumPy
# than that of FMPy); where they are not there all but the blades is left out.
. tests/checks/common.sh

# blade KEY VALUE: a blade file of OpenFAST with this line in place of that of KEY; "": without it
blade() {
  sed "s|.*$1.*|$2|" > "$out/blade.dat" << 'END'
------- ELASTODYN V1.00.* INDIVIDUAL BLADE INPUT FILE --------------------------
5 MW - a title, which is no key
---------------------- BLADE PARAMETERS ----------------------------------------
3 NBlInpSt - stations
0.4 BldFlDmp1 - percent
0.5 BldFlDmp(2) - percent
0.6 BldEdDmp1 - percent
---------------------- BLADE ADJUSTMENT FACTORS --------------------------------
1 FlStTunr1 - tuner
1 FlStTunr(2) - tuner
1.5 AdjBlMs - factor
1 AdjFlSt - factor
1 AdjEdSt - factor
---------------------- DISTRIBUTED BLADE PROPERTIES ----------------------------
BlFract PitchAxis StrcTwst BMassDen FlpStff EdgStff
(-) (-) (deg) (kg/m) (Nm^2) (Nm^2)
0 0.5 13 600 1.8e10 1.8e10
0.5 0.4 5 300 1e9 3e9
1 0.3 0 10 1e5 1e7
END
  status=0
  build/flexbeam elastodyn "$out/blade.dat" --length 60 > "$out/blade.txt" 2> "$out/log" || status=$?
}

# blade_says PATTERN STATUS: what the last one said, and its exit status
blade_says() {
  [ "$status" = "$2" ] && grep -q "$1" "$out/log" || fail "elastodyn: status $status: $(cat "$out/log")"
}
blade "no such line" ""
blade_says 'columns that are not used: PitchAxis$' 0
blade_says 'damping of flap 1, flap 2 and edge 1 differs, 0.4, 0.5 and 0.6 %: every mode has the mean$' 0
[ "$(grep -c . "$out/log")" = 2 ] && grep -q '^damping 0\.005[0 ]' "$out/blade.txt" && grep -q '^0\.5 5 450 ' "$out/blade.txt" ||
  fail "elastodyn: $(cat "$out/log" "$out/blade.txt")"
blade BldFlDmp1 '0.4 BldFlDamp1 - percent'
blade_says 'blade.dat:5: BldFlDamp1 is no key of a blade file' 2
blade BldFlDmp1 ''
blade_says 'blade.dat: no BldFlDmp1: 0 % is assumed$' 0
grep -q '^# .*no BldFlDmp1: 0 % is assumed$' "$out/blade.txt" || fail "elastodyn: $(cat "$out/blade.txt")"
blade AdjBlMs ''
blade_says 'blade.dat: no AdjBlMs: 1 is assumed$' 0
blade AdjBlMs '1 AdjFlSt - twice'
blade_says 'blade.dat:12: AdjFlSt is there twice, first in line 11$' 2
blade FlStTunr1 '1.2 FlStTunr1'
blade_says 'blade.dat:9: FlStTunr1 1.2 is not used' 0
blade BldEdDmp1 '60,0 BldEdDmp1'
blade_says 'blade.dat:7: 0 is no key' 2
blade BlFract 'BlFract StrcTwist BMassDen FlpStff EdgStff'
blade_says 'blade.dat:15: StrcTwist is no column of a blade' 2

# towers: the same reader by other names
cat > "$out/tower.dat" << 'END'
------- ELASTODYN V1.00.* TOWER INPUT FILE -------------------------------------
a title
---------------------- TOWER PARAMETERS ----------------------------------------
2 NTwInpSt - stations
1 TwrFADmp(1) - percent
1 TwrFADmp(2) - percent
1 TwrSSDmp(1) - percent
3 TwrSSDmp(2) - percent
---------------------- TOWER ADJUSTMUNT FACTORS --------------------------------
1 FAStTunr(1) - tuner
1 FAStTunr(2) - tuner
1 SSStTunr(1) - tuner
1 SSStTunr(2) - tuner
1.5 AdjTwMa - factor
2 AdjFASt - factor
1 AdjSSSt - factor
---------------------- DISTRIBUTED TOWER PROPERTIES ----------------------------
HtFract TMassDen TwFAStif TwSSStif
(-) (kg/m) (Nm^2) (Nm^2)
0 2000 1e11 4e11
1 2000 1e11 4e11
END
tower() {
  sed "s|$1|$2|" "$out/tower.dat" > "$out/tower_.dat"
  status=0
  build/flexbeam elastodyn "$out/tower_.dat" --length 80 --modes 2,2 > "$out/tower.txt" 2> "$out/log" || status=$?
}
tower none none
blade_says 'damping of fore-aft 1 and 2, side to side 1 and 2 differs, 1, 1, 1 and 3 %: every mode has the mean$' 0
try build/flexbeam analyse "$out/tower.txt" # 1.875104^2/(2 pi 80^2) sqrt(2e11/3000) = 0.71391 Hz, damped 0.71383; side to side sqrt 2 times that
grep -q ' 0\.71383[0-9]*  *0\.015$' "$out/log" && grep -q ' 1\.0095[0-9]*  *0\.015$' "$out/log" || fail "tower: $(cat "$out/log")"
try build/flexbeam elastodyn "$out/tower.txt" --shapes tower
grep -q 'TwSSM2Sh(6)' "$out/log" || fail "tower: $(cat "$out/log")"
tower 'AdjFASt' 'AdjFlSt'
blade_says 'tower_.dat:15: AdjFlSt is no key of a tower file: value and key are wanted, of NTwInpSt, TwrFADmp' 2
tower 'TMassDen' 'BMassDen'
blade_says 'tower_.dat:18: BMassDen is no column of a tower: HtFract, TMassDen, TwFAStif, TwSSStif, and of older files TwGJStif' 2
tower '^1 2000' '0.9 2000'
blade_says 'tower_.dat:21: HtFract must end at 1; 2 rows were read, as NTwInpSt says' 2

need python3 python3
python=build/venv_nastran/bin/python
"$python" -c 'import pyNastran, scipy' 2> /dev/null || skip "pyNastran is not in build/venv_nastran: sh .ci/fetch"
try ${CC:-cc} $c99 -O0 -o "$out/integrals" tests/checks/import.c -lm
try env OMP_NUM_THREADS=1 "$python" tests/checks/import.py "$out"
figures=$(tail -n 1 "$out/log")
try env OMP_NUM_THREADS=1 "$python" tests/checks/import_reduced.py "$out"
figures="$figures, $(tail -n 1 "$out/log")"
try env OMP_NUM_THREADS=1 "$python" tests/checks/import_modal.py "$out"
figures="$figures, $(tail -n 1 "$out/log")"
try env OMP_NUM_THREADS=1 "$python" tests/checks/import_size.py "$out"
figures="$figures, $(tail -n 1 "$out/log")"
for browser in chromium-headless-shell chromium; do # the page of a report draws itself
  if command -v $browser > /dev/null; then
    $browser --no-sandbox --disable-gpu --virtual-time-budget=2000 --dump-dom "file://$(cd "$out" && pwd)/report.html" > "$out/log" 2>&1 || true
    grep -q 'id="told">mode 1, 2[.]1834[0-9]* Hz<' "$out/log" || fail "$out/report.html in $browser: $(tail -n 3 "$out/log")"
    break
  fi
done
blade "no such line" ""
count=60
[ -z "${CHECK_ALL:-}" ] || count=600
try env OMP_NUM_THREADS=1 "$python" tests/checks/import_hostile.py "$out" $count "$day"
ok "$figures, $(tail -n 1 "$out/log")"
