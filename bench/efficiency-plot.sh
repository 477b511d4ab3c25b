#!/bin/sh
# Sourced by efficiency.sh, in its folder of results and with its functions and variables: efficiency.png, error
# against time, a panel for each scene that was rendered for several lengths of time.
# shellcheck disable=SC2154  # variables of efficiency.sh
# shellcheck disable=SC2086  # unquoted variables are lists
style_of() {
  case $1 in
    bdpt-before) say 'dt 2 lc rgb "#000000" pt 1' ;;
    nee-before) say 'dt 2 lc rgb "#8c8c8c" pt 2' ;;
    bdpt) say 'lc rgb "#000000" pt 7' ;;
    nee) say 'lc rgb "#8c8c8c" pt 5' ;;
    tdpt-org) say 'lc rgb "#0072b2" pt 9' ;;
    tdpt) say 'lc rgb "#56b4e9" pt 11' ;;
    tdpt-guided) say 'lc rgb "#d55e00" pt 13' ;;
    auto) say 'lc rgb "#009e73" pt 6' ;;
    *) say 'lc rgb "#cc79a7" pt 4' ;;
  esac
}
rm -f ./*.points
plotted=
for scene in $there; do
  [ "$(kind_of "$scene")" = whole ] || plotted="$plotted $scene"
done
[ -n "$plotted" ] || plotted=$there
table points "$each" >errors.txt
awk '{ print $3, $4, $5, $6 >($1 "-" $2 ".points") }' errors.txt
# The same times in every panel.
span=$(awk -v plotted="$plotted " 'index(plotted, " " $1 " ") {
    if (!least || $3 < least) least = $3
    if ($3 > most) most = $3
  }
  END { printf "[%.4g:%.4g]", most ? least / 1.4 : 0.1, most ? most * 1.4 : 1 }' errors.txt)
columns=$(set -- $plotted; [ $# -le 3 ] && echo $(($# + 1)) || echo 4)
lines=$(set -- $plotted; echo $((($# + columns) / columns)))
{
  cat <<PLOT
set terminal pngcairo size $((400 * columns)),$((340 * lines)) font "sans-serif,13" background "white"
set output "efficiency.png"
set multiplot layout $lines,$columns
set logscale xy
set format x "%g"
set format y "10^{%T}"
set xtics in (0.1, 0.3, 1, 3, 10, 30, 100)
set xlabel "CPU seconds" offset 0,0.6
set ylabel "relMSE" offset 1.2,0
set grid lc rgb "#dddddd" lt 1 lw 0.5
set border lw 1
set key off
set pointsize 1.1
set bars 0.6
set lmargin 8
set rmargin 1.5
set tmargin 2
set bmargin 3
PLOT
  for scene in $plotted; do
    black=$(awk -F '\t' -v s="$scene" '$1 == s { print $12 }' scenes.tsv)
    printf 'set title "%s" offset 0,-0.6\n' "$(say "$scene" | tr _ ' ')"
    printf 'plot %s %s with lines dt 3 lw 1.2 lc rgb "#666666" notitle' "$span" "$black"
    for i in $measured; do
      [ -s "$scene-$i.points" ] || continue
      printf ', "%s-%s.points" using 1:2:3:4 with yerrorbars lw 1 %s notitle' "$scene" "$i" "$(style_of "$i")"
      printf ', "" using 1:2 with lines lw 2 %s notitle' "$(style_of "$i" | sed 's/ pt .*//')"
    done
    printf '\n'
  done
  # The last cell holds the key alone.
  printf '%s\n' 'unset title' 'unset xlabel' 'unset ylabel' 'unset tics' 'unset border' 'unset grid' \
    'set key center center spacing 1.5 samplen 3 Left reverse'
  printf 'plot [1:2] [1:2] '
  for i in $measured; do
    printf 'NaN with linespoints lw 2 %s title "%s", ' "$(style_of "$i")" "$i"
  done
  printf 'NaN with lines dt 3 lw 1.2 lc rgb "#666666" title "all black"\n'
} >plot.gnuplot
gnuplot plot.gnuplot

