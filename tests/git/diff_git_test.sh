#!/bin/sh
# tectum diff --git, as git's diff driver and text conversion, and tools/circuit_gate, in a repository of its own.
# usage: diff_git_test.sh TECTUM SOURCE_FOLDER
set -u
tectum=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

fail() {
  echo "FAILED: $1"
  sed 's/^/    /' "$work/out"
  failures=$((failures + 1))
}

# expect STATUS WHAT COMMAND...: runs it, keeps what it printed in $work/out.
expect() {
  wanted=$1 what=$2
  shift 2
  "$@" > "$work/out" 2>&1
  got=$?
  [ "$got" = "$wanted" ] || fail "$what: exit status $got, not $wanted"
}
says() { grep -qF -- "$1" "$work/out" || fail "does not say: $1"; }
is_silent_on() { if grep -qF -- "$1" "$work/out"; then fail "says: $1"; fi }

unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE GIT_EXTERNAL_DIFF
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null TMPDIR="$work"
git init -q -b main "$work/repo" || exit 1
cd "$work/repo" || exit 1
git config user.name tester
git config user.email tester@example.org

mkdir -p circuits/parts
cat > circuits/parts/cells.json <<'JSON'
{ "tectum": 1, "neurons": { "cell": { "model": "lif_exp", "tau_m": "10 ms" } } }
JSON
cat > circuits/one.json <<'JSON'
{
  "tectum": 1, "name": "one", "tick": "1 ms", "include": "parts/cells.json",
  "neurons": { "noise": { "model": "poisson", "rate": "100 Hz" } },
  "populations": { "A": { "neuron": "noise", "size": 4 }, "B": { "neuron": "cell", "size": 4 } },
  "projections": {
    "ab": { "from": "A", "to": "B", "rule": "all_to_all", "weight": "2 nA", "delay": "1 ms" }
  }
}
JSON
cat > circuits/two.json <<'JSON'
{ "tectum": 1, "extends": "one.json", "name": "two", "parameters": {} }
JSON
printf '{ "tectum_head": 1, "name": "h" }\n' > circuits/head.json
git add . && git commit -qm first && git tag first

expect 0 "nothing has changed" "$tectum" diff --git HEAD
says "no circuit has changed since HEAD"

# A weight, in the file itself and through `extends`.
sed -i 's/2 nA/1 nA/' circuits/one.json
expect 1 "a weight has changed" "$tectum" diff --git HEAD --structure-only
says "== circuits/one.json: changed"
says "== circuits/two.json: changed"
says "1 nA instead of 2 nA"
is_silent_on "$work/tectum-"
expect 1 "one file" "$tectum" diff --git HEAD circuits/one.json --structure-only
is_silent_on "circuits/two.json: changed"
expect 1 "from a folder below" sh -c "cd circuits/parts && '$tectum' diff --git HEAD ../one.json --structure-only"
expect 1 "as JSON" "$tectum" diff --git HEAD --structure-only --format json
python3 -c 'import json,sys; d=json.load(open(sys.argv[1])); assert [f["file"] for f in d["files"]] == ["circuits/one.json", "circuits/two.json"]; assert not d["files"][0]["diff"]["same"]' "$work/out" || fail "JSON"
git commit -qam second

# What a circuit includes is the revision's as well.
sed -i 's/10 ms/12 ms/' circuits/parts/cells.json
expect 1 "an included file has changed" "$tectum" diff --git HEAD --structure-only
says "12 ms instead of 10 ms"
is_silent_on "1 nA instead of 2 nA"
git commit -qam third

expect 1 "between two commits" "$tectum" diff --git first..HEAD circuits/one.json --structure-only
says "1 nA instead of 2 nA"
says "12 ms instead of 10 ms"
git checkout -qb side first
printf '{ "tectum": 1, "extends": "one.json", "name": "three" }\n' > circuits/three.json
git add . && git commit -qm side
expect 1 "a new circuit since the fork" "$tectum" diff --git main...side --structure-only
says "== circuits/three.json: new"
is_silent_on "one.json"
git checkout -q main

# What goes wrong is said in one line.
expect 2 "an unknown revision" "$tectum" diff --git nonesuch
says 'tectum: git knows no revision `nonesuch`'
expect 2 "a file that was not there" "$tectum" diff --git side:circuits circuits/one.json
expect 2 "a file that came later" sh -c "cp circuits/one.json circuits/new.json; '$tectum' diff --git first circuits/new.json; s=\$?; rm circuits/new.json; exit \$s"
says "circuits/new.json does not exist at first"
expect 2 "no repository" sh -c "mkdir -p '$work/empty' && cd '$work/empty' && GIT_CEILING_DIRECTORIES='$work' '$tectum' diff --git HEAD"
says "is in no git repository"
expect 2 "neither two files nor a revision" "$tectum" diff circuits/one.json

# As git's own diff driver, and as its text conversion.
printf 'circuits/*.json diff=tectum\n*.image diff=tectum-image\n' > .gitattributes
git config diff.tectum.command "$tectum diff --structure-only --git-driver"
git config diff.tectum-image.textconv "$tectum dump image"
expect 0 "git diff" git diff first HEAD -- circuits/one.json circuits/parts
says "tectum diff a/circuits/one.json b/circuits/one.json"
says "1 nA instead of 2 nA"
expect 0 "git diff of what is no circuit" sh -c "sed -i 's/\"h\"/\"g\"/' circuits/head.json; git diff"
says '+{ "tectum_head": 1, "name": "g" }'
git checkout -q circuits/head.json
"$tectum" compile circuits/one.json -o one.image > "$work/out" 2>&1 || fail "compile"
git add one.image && git commit -qm image
sed -i 's/"size": 4 }, "B"/"size": 5 }, "B"/' circuits/one.json
"$tectum" compile circuits/one.json -o one.image > "$work/out" 2>&1 || fail "compile"
expect 0 "git diff of an image" git diff -- one.image
says "+"
is_silent_on "Binary files"
git checkout -q circuits/one.json one.image

# The gate of a pull request.
mkdir bin && ln -s "$tectum" bin/tectum && echo bin > .gitignore
git rm -q --cached one.image && rm -f one.image
cp "$source/circuits/oculomotor.json" circuits/ && git add . && git commit -qm oculomotor
export TECTUM=bin/tectum OUT="$work/gate"
expect 0 "nothing changed for the gate" "$source/tools/circuit_gate" HEAD
says "move the eyes as at HEAD"
sed -i 's/"w_ifn_llbn": { "value": "[0-9.]* nA"/"w_ifn_llbn": { "value": "0.001 nA"/' circuits/oculomotor.json
expect 1 "another movement for the gate" "$source/tools/circuit_gate" HEAD
says "beyond the spread"
[ -s "$work/gate/diff.html" ] || fail "no page"
expect 2 "no base for the gate" "$source/tools/circuit_gate" nonesuch

[ "$(find "$work" -maxdepth 1 -name 'tectum-*' | wc -l)" = 0 ] || { ls "$work" > "$work/out"; fail "temporary folders are left"; }
[ "$failures" = 0 ] && echo "all as expected"
exit "$failures"
