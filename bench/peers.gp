# Picture of build/bench_peers_beams.csv: error over time of beams and links. gnuplot -e "folder='...'" bench/peers.gp
panels = "spin-up slew arm pendulum links"
codes = "'flexbeam' 'flexbeam exact' 'MuJoCo' 'exudyn' 'pinocchio' 'drake'"
colors = "#cc0000 #000000 #0072b2 #009e73 #e69f00 #999999"
set datafile separator ','
set logscale xy
set format '10^{%L}'
set grid
# of a code what errs less than all that is cheaper
front(s, code) = sprintf("< sort -t, -g -k7 build/bench_peers_beams.csv | awk -F, '($2 == \"%s\" || $1 == \"%s\") && $3 == \"%s\" && $6 > 0 && (!n++ || $6 < best) { best = $6; print } END { if (!n) print \",,,,,nan,nan\" }'", \
                         s, s, code)
set terminal svg size 1000,600 font 'Helvetica,11' background '#ffffff'
set output folder . '/peers.svg'
set multiplot layout 2,3 margins 0.07,0.98,0.09,0.95 spacing 0.06,0.14
unset key
set xtics 100
set xlabel 'us of processor time per simulated second' offset 0,0.5
do for [n = 1:5] {
  s = word(panels, n)
  set title (n == 5 ? 'ten rigid links, largest angle off [rad]' : s) offset 0,-0.7
  set ylabel n % 3 == 1 ? 'largest error / largest output' : ''
  plot for [k = 1:6] front(s, word(codes, k)) using 7:6 with linespoints pt 7 ps 0.3 lw 1.5 lc rgb word(colors, k) notitle
}
unset title; unset xlabel; unset ylabel; unset tics; unset border; unset grid
set xrange [1:10]; set yrange [1:10]
set key inside center center Left reverse
plot for [k = 1:6] NaN with linespoints pt 7 ps 0.3 lw 1.5 lc rgb word(colors, k) title word(codes, k)
unset multiplot
