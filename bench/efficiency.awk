# efficiency.awk -v table=NAME -v seconds=T SCENES CSV: the tables of doc/efficiency.md, from
#   SCENES  a line for each scene, tab-separated: name, target, moonshot, relMSE wanted after a minute, its
#           moonshot, of the reference: mean, half the difference of its halves' means, relMSE, CPU seconds;
#           of the black picture: relMSE, PSNR, MAPE; of the reference: integrator, spp. "-": none.
#   CSV     doc/efficiency.csv
# T: nominal CPU seconds of the pictures that a table is about. NAME:
#   gains, psnr   all scenes and integrators
#   scene         a row for each integrator (-v scene=NAME)
#   check         a word on bdpt's mean (-v scene=NAME)
#   busy          a warning, where pictures got much less CPU time than they should
#   long          a row for each integrator with the relMSE of every seed (-v scene=NAME)
#   paper         two cells: PSNR and MAPE of tdpt against bdpt's (-v scene=NAME)
#   best          name of the best portal integrator (-v scene=NAME)
#   means         CPU seconds, relMSE, its lowest and highest; for plots (-v scene=NAME -v integrator=NAME)
#
# cost = error x CPU seconds, error = relMSE or MSE; gain of a over b = mean cost of b / mean cost of a.
# Interval of a gain: bootstrap, seeds drawn with replacement for a and for b; percentiles are widened for few
# seeds to the t distribution (Hesterberg, "What Teachers Should Know About the Bootstrap", 2015: expanded
# percentiles). A firefly that no seed met is in no interval.
BEGIN { kDraws = 2000 }

function uniform() {  # Lehmer's generator: the same numbers in every awk
  state = state * 16807 % 2147483647
  return state / 2147483647
}
function sort(a, m,    gap, i, j, x) {
  for (gap = int(m / 2); gap > 0; gap = int(gap / 2))
    for (i = gap + 1; i <= m; ++i) {
      x = a[i]
      for (j = i; j > gap && a[j - gap] > x; j -= gap) a[j] = a[j - gap]
      a[j] = x
    }
}
# Quantile of t at 97.5 %; from three degrees of freedom on by its expansion around the normal one.
function t975(df,    z) {
  if (df <= 2) return df == 1 ? 12.706 : 4.303
  z = 1.959964
  return z + (z^3 + z) / (4 * df) + (5 * z^5 + 16 * z^3 + 3 * z) / (96 * df^2) \
    + (3 * z^7 + 19 * z^5 + 17 * z^3 - 15 * z) / (384 * df^3)
}
# Upper tail of the normal distribution for x > 0 (Abramowitz and Stegun 26.2.17).
function tail(x,    u) {
  u = 1 / (1 + 0.2316419 * x)
  return exp(-x * x / 2) / 2.506628275 * u * (0.319381530 + u * (-0.356563782 + u * (1.781477937 \
    + u * (-1.821255978 + u * 1.330274429))))
}

function count(s, i) { return n[s, i, seconds] + 0 }
function field(name, s, i, k) { return value[name, s, i, seconds, k] }
function average(name, s, i,    k, sum) {
  for (k = 1; k <= count(s, i); ++k) sum += field(name, s, i, k)
  return count(s, i) ? sum / count(s, i) : 0
}
function cost(s, i, error,    k, sum) {
  for (k = 1; k <= count(s, i); ++k) sum += field(error, s, i, k) * field("cpu_seconds", s, i, k)
  return count(s, i) ? sum / count(s, i) : 0
}
function drawn_cost(s, i, error,    k, m, at, sum) {
  m = count(s, i)
  for (k = 1; k <= m; ++k) {
    at = 1 + int(uniform() * m)
    sum += field(error, s, i, at) * field("cpu_seconds", s, i, at)
  }
  return sum / m
}
# Sets gain (0: unknown) of a over b, and low and high (0: no interval).
function compare(s, a, b, error,    m, r, c, d, level, ratio) {
  gain = low = high = 0
  if (cost(s, a, error) <= 0 || cost(s, b, error) <= 0) return
  gain = cost(s, b, error) / cost(s, a, error)
  m = count(s, a) < count(s, b) ? count(s, a) : count(s, b)
  if (a == b || m < 2) return
  state = 20240229
  for (r = 1; r <= kDraws; ++r) {
    c = drawn_cost(s, a, error)
    d = drawn_cost(s, b, error)
    # Costs that the reference's noise takes below zero might be any.
    ratio[r] = c <= 0 ? 1e9 : (d > 0 ? d / c : 0)
  }
  sort(ratio, kDraws)
  level = int(tail(sqrt(m / (m - 1)) * t975(m - 1)) * kDraws)
  low = ratio[1 + level]
  high = ratio[kDraws - level]
}

function digits(x) {
  return sprintf(x < 0.095 ? "%.2g" : x < 0.995 ? "%.2f" : x < 9.95 ? "%.1f" : x < 999.5 ? "%.0f" : "%.2g", x)
}
function gain_text() {
  if (gain <= 0) return "-"
  return digits(gain) (high > 0 ? " [" digits(low) ", " (high < 1e8 ? digits(high) : "?") "]" : "")
}
function decibels(x) { return sprintf("%+.1f", 10 * log(x) / log(10)) }
function psnr_text() {
  if (gain <= 0) return "-"
  return decibels(gain) (low > 0 && high < 1e8 ? " [" decibels(low) ", " decibels(high) "]" : "")
}
function number(x, format) { return x == "" || x == "-" ? "-" : sprintf(format, x) }
# Of gain, low and high: whether at least `wanted`.
function verdict(wanted) {
  if (gain <= 0) return "-"
  if (gain >= wanted) return high == 0 || low >= wanted ? "met" : "met, but within the noise"
  return high >= wanted ? "missed, but within the noise" : "missed"
}
function portal_integrator(i) { return i ~ /^tdpt|^auto/ }
# The cheapest on scene s; among those with portals, or among all but one.
function best(s, portals, but,    k, i, winner, c, least) {
  for (k = 1; k <= integrators; ++k) {
    i = order[k]
    c = cost(s, i, "relmse")
    if (i == but || c <= 0 || (portals && !portal_integrator(i))) continue
    if (!winner || c < least) { winner = i; least = c }
  }
  return winner
}
function target_text(s) {
  if (target[s] == "-") return "-"
  if (target[s] == "others") return "0.9 x the best other"
  return target[s] (moonshot[s] == "-" ? "" : " (" moonshot[s] ")")
}
# Whether integrator i meets the target of s.
function met(s, i,    other) {
  if (!i || target[s] == "-" || !portal_integrator(i)) return "-"
  if (target[s] != "others") {
    compare(s, i, "bdpt", "relmse")
    return verdict(target[s] + 0)
  }
  other = best(s, 0, i)
  if (!other) return "-"
  compare(s, i, other, "relmse")
  return verdict(0.9) ": " gain_text() " x " other
}
# Sets mean of all pictures of i, runs of them, weight = their samples per pixel, and spread = variance of the
# mean of a picture of one sample per pixel.
function all_means(s, i,    t, k, w, x, square) {
  mean = runs = weight = spread = 0
  for (t in times)
    for (k = 1; k <= n[s, i, t]; ++k) {
      w = value["spp", s, i, t, k]
      x = value["mean", s, i, t, k]
      mean += w * x
      square += w * x * x
      weight += w
      ++runs
    }
  if (!runs) return
  mean /= weight
  if (runs > 1) spread = (square - weight * mean * mean) / (runs - 1)
  if (spread < 0) spread = 0
}
# Mean of i over the reference's. Sets error, one standard error of it: the reference's noise is known from
# other pictures of its integrator, or, from none, roughly from its halves.
function mean_ratio(s, i,    noise) {
  if (reference[s] <= 0) return 0
  all_means(s, reference_integrator[s])
  noise = runs > 2 ? spread / reference_spp[s] : half[s]^2
  all_means(s, i)
  if (!runs) return 0
  error = sqrt(spread / weight + noise) / reference[s]
  return mean / reference[s]
}

function range(s, i,    k, x) {
  least = most = field("relmse", s, i, 1)
  for (k = 2; k <= count(s, i); ++k) {
    x = field("relmse", s, i, k)
    if (x < least) least = x
    if (x > most) most = x
  }
}

function print_overview(head,    k) {
  printf "| scene |"
  for (k = 1; k <= integrators; ++k) if (order[k] != "bdpt") printf " %s |", order[k]
  printf " %s |\n|---|", head
  for (k = 1; k <= integrators; ++k) if (order[k] != "bdpt") printf "---|"
  print head ~ /\|/ ? "---|---|" : "---|"
}
function print_gains(    j, k, s, i) {
  print_overview("target (moonshot) | met by the best with portals")
  for (j = 1; j <= all; ++j) {
    s = scenes[j]
    printf "| %s |", s
    for (k = 1; k <= integrators; ++k) {
      if ((i = order[k]) == "bdpt") continue
      compare(s, i, "bdpt", "relmse")
      printf " %s |", gain_text()
    }
    i = best(s, 1)
    printf " %s | %s |\n", target_text(s), !i || target[s] == "-" ? "-" : i ": " met(s, i)
  }
}
function print_psnr(    j, k, s, i) {
  print_overview("at least -0.3 dB, by the best with portals")
  for (j = 1; j <= all; ++j) {
    s = scenes[j]
    printf "| %s |", s
    for (k = 1; k <= integrators; ++k) {
      if ((i = order[k]) == "bdpt") continue
      compare(s, i, "bdpt", "mse")
      printf " %s |", psnr_text()
    }
    if ((i = best(s, 1))) compare(s, i, "bdpt", "mse")
    printf " %s |\n", i ? i ": " verdict(10^-0.03) : "-"
  }
}
function print_scene(s,    k, i, ratio, says, dB) {
  print "| integrator | spp | CPU s | relMSE [seeds] | PSNR [dB] | MAPE [%] | mean / reference | gain | target | met | PSNR - bdpt's |"
  print "|---|---|---|---|---|---|---|---|---|---|---|"
  for (k = 1; k <= integrators; ++k) {
    i = order[k]
    if (!count(s, i)) continue
    range(s, i)
    ratio = mean_ratio(s, i)
    says = met(s, i)
    compare(s, i, "bdpt", "mse")
    dB = i == "bdpt" ? "0" : psnr_text()
    compare(s, i, "bdpt", "relmse")
    printf "| %s | %.3g | %.2f | %.3g [%.3g, %.3g] | %s | %.3g | %.4f +- %.4f | %s | %s | %s | %s |\n", i,
      average("spp", s, i), average("cpu_seconds", s, i), average("relmse", s, i), least, most,
      psnr_of(s, i), average("mape", s, i), ratio, error, i == "bdpt" ? "1" : gain_text(),
      portal_integrator(i) ? target_text(s) : "-", says, dB
  }
  printf "| all black | - | - | %s | %s | %s | 0 | - | - | - | - |\n", number(black[s], "%.3g"),
    number(black_psnr[s], "%.2f"), number(black_mape[s], "%.3g")
}
# PSNR of the mean MSE.
function psnr_of(s, i,    k, mse, peak) {
  mse = average("mse", s, i)
  for (k = 1; k <= count(s, i) && !peak; ++k)
    if (field("psnr", s, i, k) != "") peak = field("mse", s, i, k) * 10^(field("psnr", s, i, k) / 10)
  return mse > 0 && peak ? sprintf("%.2f", 10 * log(peak / mse) / log(10)) : "-"
}
function print_check(s,    ratio, off) {
  ratio = mean_ratio(s, "bdpt")
  if (!ratio || !error || runs < 4) {
    print "No check: bdpt was not rendered often enough."
    return
  }
  off = (ratio - 1) / error
  printf "Check: the mean of all of bdpt's pictures is %.4f +- %.4f of the reference's, %+.1f standard errors: %s.\n",
    ratio, error, off, (off * off < 9 ? "they agree" : "THEY DISAGREE")
}
function print_long(s,    k, i, m, said, goal, reached) {
  for (k = 1; k <= integrators; ++k) {
    i = order[k]
    if (!count(s, i)) continue
    range(s, i)
    said = ""
    for (m = 1; m <= count(s, i); ++m) said = said (m > 1 ? ", " : "") sprintf("%.3g", field("relmse", s, i, m))
    goal = wanted[s] == "-" ? "-" : "at most " wanted[s] " (" wanted_moonshot[s] "), every seed"
    reached = wanted[s] == "-" || !portal_integrator(i) ? "-" : (most <= wanted[s] + 0 ? "met" : "missed")
    printf "| %s | %s | %.1f | %s | %s |\n", i, said, average("cpu_seconds", s, i), goal, reached
  }
}
function print_busy(    j, k, m, sum, pictures) {
  for (j = 1; j <= all; ++j)
    for (k = 1; k <= integrators; ++k)
      for (m = 1; m <= count(scenes[j], order[k]); ++m) {
        sum += field("cpu_seconds", scenes[j], order[k], m)
        ++pictures
      }
  if (pictures && sum / pictures < 0.85 * seconds)
    printf "The machine was busy: on average a picture got %.3g of its %s CPU seconds.\n", sum / pictures, seconds
}
function print_paper(s) {
  compare(s, "tdpt", "bdpt", "mse")
  if (gain <= 0) print "- | -"
  else printf "%s dB | %.3g %% against %.3g %%\n", decibels(gain), average("mape", s, "tdpt"), average("mape", s, "bdpt")
}

FNR == 1 { ++file; if (file == 2) { split($0, name, ","); next } }
file == 1 {
  split($0, f, "\t")
  s = scenes[++all] = f[1]
  target[s] = f[2]; moonshot[s] = f[3]; wanted[s] = f[4]; wanted_moonshot[s] = f[5]
  reference[s] = f[6]; half[s] = f[7]
  black[s] = f[10]; black_psnr[s] = f[11]; black_mape[s] = f[12]
  reference_integrator[s] = f[13]; reference_spp[s] = f[14]
  next
}
{
  columns = split($0, f, ",")
  for (k = 1; k <= columns; ++k) row[name[k]] = f[k]
  s = row["scene"]; i = row["integrator"]; t = row["seconds"]
  if (!(i in seen)) { seen[i] = 1; order[++integrators] = i }
  times[t] = 1
  m = ++n[s, i, t]
  for (k = 1; k <= columns; ++k) value[name[k], s, i, t, m] = f[k]
}
END {
  if (table == "gains") print_gains()
  else if (table == "psnr") print_psnr()
  else if (table == "scene") print_scene(scene)
  else if (table == "check") print_check(scene)
  else if (table == "check") print_check(scene)
  else if (table == "busy") print_busy()
  else if (table == "long") print_long(scene)
  else if (table == "paper") print_paper(scene)
  else if (table == "best") print best(scene, 1)
  else if (table == "means" && count(scene, integrator)) {
    range(scene, integrator)
    if (average("relmse", scene, integrator) > 0)
      printf "%.6g %.6g %.6g %.6g\n", average("cpu_seconds", scene, integrator),
        average("relmse", scene, integrator), (least > 0 ? least : average("relmse", scene, integrator)), most
  }
}
