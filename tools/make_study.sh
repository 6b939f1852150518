#!/usr/bin/env bash
# Makes docs/study.md and its pictures: the whole study, in under an hour. Goes on where it was stopped.
# make_study.sh WEFT DOCS
set -euo pipefail
weft=$1 docs=$2
work=${WEFT_STUDY_DIR:-out/study}

"$weft" study all --out "$work"
mkdir -p "$docs/study"
rm -f "$docs"/study/*.svg "$docs"/study/*.jpg
find "$work" -maxdepth 1 \( -name '*.svg' -o -name '*.jpg' \) -exec cp {} "$docs/study/" \;
sed 's|](\./|](study/|' "$work/study.md" > "$docs/study.md"
