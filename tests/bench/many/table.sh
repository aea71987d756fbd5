#!/bin/sh
# What the runs of run.sh took, one row a folder, by unknowns and inputs: table.sh FOLDER ... ; with CSV=file as CSV too.
# Runs that wrote no ROM file are left out, and named on the error output.
set -e
row() {
  awk -v folder="$1" '
    FILENAME ~ /\.log$/ && / unknowns, [0-9]+ patches, on / { for (i = 1; i < NF; i++) {
      if ($(i + 1) == "unknowns,") n = $i
      if ($(i + 1) ~ /^patches/) m = $i
      if ($(i + 1) ~ /^rank/) ranks = $i } }
    FILENAME ~ /\.log$/ && /differ from the full model/ { for (i = 1; i < NF; i++) if ($i == "most") { error = $(i + 1); break } }
    FILENAME ~ /\.log$/ && / wrote / { for (i = 1; i < NF; i++) if ($(i + 1) == "states") { states = $i; break } }
    /User time/ { cpu += $NF } /System time/ { cpu += $NF } /Maximum resident/ { mib = $NF / 1024 }
    END {
      if (!states) { print folder ": no ROM file was written" > "/dev/stderr"; exit }
      printf "%d,%d,%d,%d,%.2f,%.1f,%.0f,%.3g\n", n, m, ranks, states, states / m, cpu, mib, 100 * error }
  ' "$1"/*.log "$1/time"
}
for folder in "$@"; do row "$folder"; done | sort -t, -k1,1n -k2,2n |
  awk -F, -v csv="$CSV" '
    BEGIN {
      if (csv) print "unknowns,inputs,ranks,states,states_per_input,cpu_seconds,memory_mib,error_percent" > csv
      print "| unknowns | inputs | ranks | states | an input | CPU s | MiB | error |"
      print "|---|---|---|---|---|---|---|---|" }
    { if (csv) print > csv
      printf "| %s | %s | %s | %s | %s | %s | %s | %s %% |\n", $1, $2, $3, $4, $5, $6, $7, $8 }'
