#!/usr/bin/env bash
# tectum sweep as a user meets it: killed and resumed, and as jobs for GNU parallel and Slurm, always the same table.
# usage: sweep_command_test.sh TECTUM CIRCUIT_FOLDER
set -euo pipefail
tectum=$(realpath "$1")
circuits=$(realpath "$2")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
cp -r "$circuits" circuits

fail() { echo "FAILED: $*" >&2; exit 1; }
sweep=("$tectum" sweep circuits/oculomotor.json -p "error_gain=0.4..0.44nA/deg:3" -p seed=0..1 --duration 2)

"${sweep[@]}" --out whole --threads 1 >whole.txt
[ "$(wc -l <whole/sweep.csv)" = 7 ] || fail "expected a header and six rows in whole/sweep.csv"
grep -q '^0.42 nA/deg,1,' whole/sweep.csv || fail "the middle of the range is missing"
grep -q '<svg' whole/sweep.html || fail "no heat map in whole/sweep.html"

echo "two runs side by side give the table of one at a time"
"${sweep[@]}" --out pair --threads 2 >/dev/null
cmp whole/sweep.csv pair/sweep.csv || fail "the number of threads changed the table"

echo "a sweep that is killed goes on where it was"
"${sweep[@]}" --out killed --threads 1 >/dev/null 2>&1 &
victim=$!
rows() { find killed/rows -name '*.csv' 2>/dev/null | wc -l; }
while [ "$(rows)" -lt 2 ] && kill -0 "$victim" 2>/dev/null; do sleep 0.02; done
kill -9 "$victim" 2>/dev/null || true
wait "$victim" 2>/dev/null || true
kept=$(rows)
[ "$kept" -ge 2 ] || fail "nothing was kept"
"${sweep[@]}" --out killed >killed.txt
if [ "$kept" -lt 6 ]; then
  grep -q "$((6 - kept)) run now.*, $kept kept from before" killed.txt || fail "ran again what was kept: $(head -1 killed.txt)"
fi
cmp whole/sweep.csv killed/sweep.csv || fail "the resumed table is another"

echo "a row that was cut short is run again"
for row in killed/rows/*.csv; do truncate -s 150 "$row"; break; done
"${sweep[@]}" --out killed >killed.txt
grep -q '1 run now' killed.txt || fail "took a damaged row for whole: $(head -1 killed.txt)"
cmp whole/sweep.csv killed/sweep.csv || fail "the mended table is another"

echo "the jobs for GNU parallel give the same table"
"${sweep[@]}" --out jobs --emit parallel >jobs.txt 2>/dev/null
[ "$(wc -l <jobs.txt)" = 6 ] || fail "expected six jobs"
[ ! -e jobs ] || fail "--emit ran something"
if command -v parallel >/dev/null; then
  parallel -j 2 <jobs.txt 2>/dev/null
else
  bash -e jobs.txt  # each line is a command by itself
fi
"${sweep[@]}" --out jobs >jobs_table.txt
grep -q '0 run now, 6 kept from before' jobs_table.txt || fail "the jobs left work: $(head -1 jobs_table.txt)"
cmp whole/sweep.csv jobs/sweep.csv || fail "the jobs' table is another"

echo "the job array for Slurm gives the same table"
"${sweep[@]}" --out array --emit slurm >array.sh 2>/dev/null
grep -q '^#SBATCH --array=0-5$' array.sh || fail "no array of six"
for task in $(seq 0 5); do SLURM_ARRAY_TASK_ID=$task bash array.sh; done
"${sweep[@]}" --out array >array.txt
grep -q '0 run now, 6 kept from before' array.txt || fail "the array left work: $(head -1 array.txt)"
cmp whole/sweep.csv array/sweep.csv || fail "the array's table is another"

echo "an edit of the protocol is not taken for what was run before, unless no run can tell"
sed 's/"trials": 5/"trials": 6/' circuits/protocols/step.json >again.json
sed 's/"extent": "0.2 m"/"extent": "0.1 m"/' circuits/protocols/step.json >narrower.json
cmp -s again.json narrower.json && fail "the edits of the protocol did nothing"
"${sweep[@]}" --protocol again.json --out jobs >edited.txt
grep -q '0 run now' edited.txt || fail "ran again what is the same: $(head -1 edited.txt)"
"${sweep[@]}" --protocol narrower.json --out jobs >edited.txt
grep -q '6 run now' edited.txt || fail "kept rows of another protocol: $(head -1 edited.txt)"

echo "an edit of the circuit is not taken for what was run before"
sed -i 's/"amplitude_gain": { "value": "[0-9.]*"/"amplitude_gain": { "value": "1.40"/' circuits/oculomotor.json
"${sweep[@]}" --out jobs >edited.txt
grep -q '6 run now' edited.txt || fail "kept rows of another circuit: $(head -1 edited.txt)"
echo "all as expected"
