#!/usr/bin/env bash
# Makes docs/study/study.md and its pictures: the whole study, in under an hour. Resumes an interrupted run.
# make_study.sh WEFT FOLDER
set -euo pipefail
weft=$1 folder=$2
work=${WEFT_STUDY_DIR:-out/study}

"$weft" study all --out "$work"
mkdir -p "$folder"
rm -f "$folder"/*.svg "$folder"/*.jpg
find "$work" -maxdepth 1 \( -name '*.svg' -o -name '*.jpg' \) -exec cp {} "$folder/" \;
sed 's|](\./|](|' "$work/study.md" > "$folder/study.md"
