#!/usr/bin/env python3
"""Lists long sentences and replaced words in pages, comments and messages.

    tools/plain_words.py [--count] [FILE or FOLDER ...]

Reads the word table of docs/explanation/vocabulary.md. Text: Markdown files, comments of C++ files, and string literals of
C++ files that contain a space. Skipped: code blocks, diagrams, tables of keys, raw strings, generated pages, the CHANGELOG
and the vocabulary itself. Needs the standard library of Python 3.9 only.
"""

import argparse
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
VOCABULARY = ROOT / "docs/explanation/vocabulary.md"
MAX_WORDS = 25
SKIPPED = {  # generated, history, or the list itself
    "docs/explanation/vocabulary.md",
    "docs/reference/scene_keys.md",
    "docs/study/study.md",
    "CHANGELOG.md",
}
CPP = {".h", ".cpp"}
WORD = re.compile(r"[^\W\d_]{2}|^\W*(?:\d|[aIA]\W*$)|X")  # not the single letters of formulas
KEY_TABLES = ("key", "symbol")  # first header cell of a table that lists names


def read_vocabulary():
    """[(pattern, replacement)] of the table under the heading Words."""
    rows = []
    text = VOCABULARY.read_text(encoding="utf-8").split("\n## Words\n")[1]
    for line in text.splitlines():
        cells = re.split(r"(?<!\\)\|", line)[1:-1]
        if len(cells) != 3:
            continue
        for pattern in re.findall(r"`([^`]+)`", cells[2]):
            rows.append((re.compile(pattern.replace(r"\|", "|"), re.IGNORECASE), cells[1].strip()))
    return rows


class Block:
    """A paragraph of text with the line number of every character."""

    def __init__(self):
        self.text, self.lines = "", []

    def add(self, text, line):
        if self.text and not self.text.endswith(" "):
            text = " " + text
        self.text += text
        self.lines += [line] * len(text)

    def line_at(self, offset):
        return self.lines[min(offset, len(self.lines) - 1)]


def cells_of(row):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip().strip("|"))]


def markdown_blocks(text):
    block, fenced, header = Block(), False, None
    previous_blank, in_list = True, False
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            fenced = not fenced
            stripped = ""
        is_item = re.match(r"\s*([-*]|\d+\.) ", line)
        if is_item:
            in_list = True
        elif stripped and not line.startswith(" "):
            in_list = in_list and not previous_blank
        if fenced or not stripped or (line.startswith("    ") and not is_item and
                                      (not in_list or previous_blank or line.startswith("       "))):
            yield block
            block, header = Block(), None
            previous_blank = not stripped or previous_blank
            continue
        if stripped.startswith("|"):
            yield block
            block = Block()
            cells = cells_of(stripped)
            header = header or cells
            if header[0] not in KEY_TABLES and not re.fullmatch(r"[-:| ]+", stripped):
                for cell in cells:
                    one = Block()
                    one.add(cell, number)
                    yield one
        else:
            if is_item or stripped.startswith("#") or stripped.startswith("!["):
                yield block
                block = Block()
            block.add(re.sub(r"^([-*]|\d+\.|#+) ", "", stripped), number)
            if stripped.startswith("#"):
                yield block
                block = Block()
        previous_blank = False
    yield block


TOKEN = re.compile(
    r'(?P<comment>//[^\n]*)|(?P<long>/\*.*?\*/)|(?P<raw>R"(?P<tag>[^(\s]*)\(.*?\)(?P=tag)")'
    r'|(?P<string>"(?:\\.|[^"\\\n])*")|(?P<char>\'(?:\\.|[^\'\\\n])*\')|(?P<number>\b\d[\w.\']*)|(?P<line>\n)|(?P<code>[^\s])',
    re.DOTALL)


def cpp_blocks(text):
    """Comments, joined over lines, and string literals, joined where the compiler joins them."""
    number, line_start = 1, 0
    comment, comment_end, column = Block(), -1, -1
    literal, literal_open = Block(), False
    code_on_line = preprocessor = False
    for match in TOKEN.finditer(text):
        kind, found = match.lastgroup if match.lastgroup != "tag" else "raw", match.group()
        if kind == "line":
            number, line_start, code_on_line, preprocessor = number + 1, match.end(), False, False
            continue
        if kind == "comment":
            words = re.sub(r"^/+<?", "", found)
            at = match.start() - line_start
            joins = not code_on_line and comment_end == number - 1 and at == column
            indent = len(words) - len(words.lstrip())
            is_item = re.match(r"\s*([-*]|\d+\.) ", words)
            diagram = indent >= 3 and not (joins and indent == 3 and comment.text)
            if not joins or not words.strip() or diagram or is_item:
                yield comment
                comment = Block()
            if words.strip() and not diagram:
                comment.add(re.sub(r"^([-*]|\d+\.) ", "", words.strip()), number)
            comment_end, column = number, at
            continue
        if kind == "string" and not preprocessor:
            inner = found[1:-1].replace("\\n", " ").replace('\\"', '"')
            if literal_open:
                literal.text = literal.text.rstrip("\0")
                literal.text += inner
                literal.lines += [number] * len(inner)
            else:
                yield literal if " " in literal.text.strip() else Block()
                literal = Block()
                literal.add(inner, number)
            literal_open = True
        elif kind not in ("long",):
            literal_open = False
            preprocessor = preprocessor or (found == "#" and not code_on_line)
        code_on_line = True
        number += found.count("\n")
        if "\n" in found:
            line_start = match.start() + found.rfind("\n") + 1
    yield comment
    yield literal if " " in literal.text.strip() else Block()


def plain(text):
    """Without inline code, pictures, link targets and emphasis: same length, so that offsets stay."""
    blank = lambda m: "X" + " " * (len(m.group()) - 1)
    text = re.sub(r"`[^`]*`", blank, text)
    text = re.sub(r"\]\([^)]*\)", lambda m: " " * len(m.group()), text)
    text = re.sub(r"<[^>]+>", lambda m: " " * len(m.group()), text)
    return re.sub(r"[*!\[\]]", " ", text)


def sentences(text):
    start = 0
    for match in re.finditer(r"(?<!\be\.g)(?<!\bi\.e)(?<!\bcf)(?<!\bvs)(?<!\bet al)[.?!…]['\")”]*(?=\s+[^a-z\s]|\s*$)", text):
        yield start, text[start:match.end()]
        start = match.end()
    yield start, text[start:]


def find_places(path, vocabulary):
    text = path.read_text(encoding="utf-8", errors="replace")
    for block in markdown_blocks(text) if path.suffix == ".md" else cpp_blocks(text):
        if not block.text.strip():
            continue
        shown = plain(block.text)
        for start, sentence in sentences(shown):
            count = sum(1 for word in sentence.split() if WORD.search(word))
            if count > MAX_WORDS:
                begin = start + len(sentence) - len(sentence.lstrip())
                head = " ".join(block.text[begin:begin + 60].split())
                yield block.line_at(begin), "long", f"{count} words: {head} …"
        for pattern, instead in vocabulary:
            for match in pattern.finditer(shown):
                yield block.line_at(match.start()), "word", f"\"{match.group()}\" → {instead}"


def files_of(arguments):
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *arguments], cwd=ROOT,
                            capture_output=True, text=True, check=True).stdout.split("\n")
    for name in sorted(set(listed)):
        path = ROOT / name
        if name and name not in SKIPPED and path.suffix in CPP | {".md"} and path.exists():
            yield name, path


def folder_of(name):
    parts = pathlib.PurePosixPath(name).parts[:-1]
    return "/".join(parts[:3] if parts[:1] == ("src",) else parts[:2]) or "."


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", action="store_true", help="totals per folder instead of the places")
    parser.add_argument("paths", nargs="*", help="files or folders of the repository; default: all")
    options = parser.parse_args()
    vocabulary = read_vocabulary()
    totals = collections.defaultdict(collections.Counter)
    for name, path in files_of(options.paths):
        for line, kind, message in sorted(find_places(path, vocabulary)):
            totals[folder_of(name)][kind] += 1
            if not options.count:
                print(f"{name}:{line}: {message}")
    if options.count:
        rows = sorted(totals.items())
        rows.append(("in all", sum((counts for _, counts in rows), collections.Counter())))
        print(f"{'folder':<24} {'long':>6} {'words':>6}")
        for folder, counts in rows:
            print(f"{folder:<24} {counts['long']:>6} {counts['word']:>6}")


if __name__ == "__main__":
    try:
        main()
    except BrokenPipeError:
        sys.stderr.close()
