#!/usr/bin/env bash
# Flow lengths of a study beside Flemings' formula, as a table: flemings.sh STUDY_FOLDER
#   L = a rho v (k L_f + c dT)/(h (T_m - T_0)) (1 + B/2),   B = h sqrt(pi alpha L/v)/kappa
# v is the front's speed between 3.5 and 6.5 mm of rise, from the times at which two features are half full; dT reaches down to the
# temperature of the solid fraction k at which melt stops, T_m is the mean on the way there; alpha, kappa: the die's. L is in
# B too, so it is found by iteration.
set -euo pipefail
cd "$1"
half_full() { awk -F 'mm3' -v name="$2" 'index($1, name) && !done { split($2, t, " "); print t[1]; done = 1 }' "$1/summary.txt"; }
echo "| die | melt | front | flow length | Flemings | difference |"
echo "|---|---|---|---|---|---|"
awk -F, '/^run,/ { for (k = 1; k <= NF; k++) column[$k] = k }
  /^run-/ && $column["outcome"] == "finished" {
    print $1 "," $column["preheat"] "," $column["melt.temperature"] "," $column["filled"]
  }' study.csv | while IFS=, read -r run preheat melt filled; do
  awk -v preheat="${preheat% degC}" -v melt="${melt% degC}" -v filled="$filled" \
    -v low="$(half_full "$run" 'rise 3 to 4 mm')" -v high="$(half_full "$run" 'rise 6 to 7 mm')" 'BEGIN {
    a = 0.25e-3; rho = 2400; c = 1190; latent = 389e3; liquidus = 615; range = 60; k = 0.25     # A356, 1 x 1 mm
    h = 2500; kappa = 27; alpha = kappa / (7750 * 500)                                          # contact; H13 steel
    v = 3 / (high - low)                                                                        # mm/ms = m/s
    last = liquidus - k * range
    first = a * rho * v * (k * latent + c * (melt - last)) / (h * ((melt + last) / 2 - preheat))
    length_ = first
    for (i = 0; i < 50; i++) length_ = first * (1 + h * sqrt(3.14159265 * alpha * length_ / v) / kappa / 2)
    ours = 25e-3 * filled                                                                       # m, of a channel of 25 mm3
    printf "| %s degC | %s degC | %.3f m/s | %.1f mm | %.1f mm | %+.0f %% |\n", preheat, melt, v, 1e3 * ours, 1e3 * length_, 100 * (ours / length_ - 1)
  }'
done
