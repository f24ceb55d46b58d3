# Pictures of accuracy.csv: error over time for each scene, and one of all. gnuplot -e "folder='...'" bench/accuracy.gp
scenes = "spin-up rotor slew arm pendulum shaken tumbling sag"
rungs = "linear some full strain large exact"
colors = "#999999 #e69f00 #0072b2 #009e73 #cc0000 #000000"
width(k) = k == 5 ? 2.5 : 1.5
set datafile separator ','
set logscale xy
set format '10^{%L}'
set yrange [3e-6:2]
set grid
# column 10 is the error, 11 the time; 12 and 13 say what is on the front of all and of its rung
rows(s, rung, column) = sprintf("< awk -F, '$1 == \"%s\" && (\"%s\" == \"\" || $2 == \"%s\") && $%d == 1' %s/accuracy.csv", \
                                s, rung, rung, column, folder)
all(s, rung) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\"' %s/accuracy.csv", s, rung, folder)

set terminal svg size 900,560 font 'Helvetica,14' background '#ffffff'
set xlabel 'stepping [us per simulated second]'
set ylabel 'largest error / largest output'
set key outside right
do for [s in scenes] {
  set output folder . '/' . s . '.svg'
  set title s
  plot for [k = 1:6] all(s, word(rungs, k)) using 11:10 with points pt 7 ps 0.3 lc rgb word(colors, k) title word(rungs, k), \
       rows(s, '', 12) using 11:10 with steps lw 1 dt 2 lc rgb '#000000' title 'best'
}

# all in one; the key of all rungs is a panel of its own, below the others
set terminal svg size 1000,600 font 'Helvetica,11' background '#ffffff'
set output folder . '/accuracy.svg'
set multiplot layout 2,4 margins 0.07,0.98,0.13,0.95 spacing 0.055,0.14
unset key
set xlabel 'us per simulated second' offset 0,0.5
set xrange [1:1e6]
set xtics 100
do for [n = 1:8] {
  s = word(scenes, n)
  set title s offset 0,-0.7
  set ylabel n % 4 == 1 ? 'error' : ''
  plot for [k = 1:6] rows(s, word(rungs, k), 13) using 11:10 with linespoints pt 7 ps 0.3 lw width(k) lc rgb word(colors, k) notitle
}
unset title; unset xlabel; unset ylabel; unset tics; unset border; unset grid
set lmargin at screen 0.1; set rmargin at screen 0.9; set tmargin at screen 0.06; set bmargin at screen 0
set key inside center center horizontal Left reverse
plot for [k = 1:6] NaN with linespoints pt 7 ps 0.3 lw width(k) lc rgb word(colors, k) title word(rungs, k)
unset multiplot
