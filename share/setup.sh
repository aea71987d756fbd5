# Sourced by the README's commands and by CI: install what is missing on Debian 12, then build into $build.
# Usage: . share/setup.sh; setup_packages; setup_build BUILD_FOLDER [meson options]
setup_packages_needed="gcc git meson ninja-build pkg-config libhdf5-dev libyaml-dev libudunits2-dev nettle-dev
  libjansson-dev libcairo2-dev libcmocka-dev petsc-dev slepc-dev libgmsh-dev libhdf5-openmpi-dev openmpi-bin
  libopenblas0-serial fonts-dejavu-core"

setup_packages() {
  local missing="" package
  command -v dpkg-query >/dev/null 2>&1 || return 0 # not Debian: meson says what it does not find
  for package in $setup_packages_needed; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  local as_root=""
  [ "$(id -u)" = 0 ] || as_root="sudo"
  echo "Installing:$missing"
  $as_root apt-get update -q </dev/null >/dev/null
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing </dev/null >/dev/null
}

setup_build() {
  local folder=$1
  shift
  [ -f "$folder/build.ninja" ] || meson setup "$folder" "$@" >/dev/null || { cat "$folder/meson-logs/meson-log.txt"; return 1; }
  ninja -C "$folder" --quiet
}

# Build, then run the example in the given folder: reduce its mould, cast into it, draw.
setup_run_example() {
  export OMP_WAIT_POLICY=passive # waiting threads sleep: kinder, and on a shared machine much faster
  setup_packages
  setup_build build
  local build=$PWD/build
  cd "$1"
  "$build/reduce/castreduce" run mould.yaml
  "$build/cast/castrun" run cast.yaml
  "$build/cast/castrun" draw results
  echo
  echo "Results:  $PWD/results   (results.xmf and mould.xmf open in ParaView)"
  echo "Picture:  $PWD/results/filling.png"
  echo "Summary:  $PWD/results/summary.txt"
}

# Build, then run the study of the given folder: reduce its mould once, then one run after the other.
setup_run_study() {
  export OMP_WAIT_POLICY=passive
  setup_packages
  setup_build build
  local build=$PWD/build
  cd "$1"
  "$build/reduce/castreduce" run mould.yaml
  "$build/cast/castrun" sweep "$2"
  local run
  for run in study/run-*; do "$build/cast/castrun" draw "$run"; done
  echo
  echo "Table:    $PWD/study/study.csv"
  echo "Picture:  $PWD/study/study.png"
  echo "Runs:     $PWD/study/run-0001 and so on, each with its pictures and summary"
}
