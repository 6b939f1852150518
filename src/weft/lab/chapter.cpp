#include "weft/lab/chapter.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "weft/error.h"

namespace weft::engine {
namespace {

using Json = nlohmann::ordered_json;

constexpr Verdict kVerdicts[] = {Verdict::holds, Verdict::holds_in_part, Verdict::fails, Verdict::finding};

Json json_of(const Claim& claim) {
  Json json = {{"title", claim.title},     {"source", claim.source},   {"verdict", to_string(claim.verdict)},
               {"text", claim.text},       {"figures", Json::array()}, {"tables", Json::array()},
               {"pictures", Json::array()}};
  for (const KeyFigure& f : claim.figures) {
    json["figures"].push_back(
        {{"name", f.name}, {"value", f.value}, {"unit", f.unit}, {"aim", f.aim}, {"tolerance", f.tolerance}});
  }
  for (const Table& t : claim.tables)
    json["tables"].push_back({{"title", t.title}, {"head", t.head}, {"rows", t.rows}});
  for (const Figure2d& p : claim.pictures)
    json["pictures"].push_back({{"file", p.file}, {"caption", p.caption}, {"svg", p.svg}});
  return json;
}

Json json_of(const Chapter& chapter) {
  Json json = {
      {"study", chapter.name},      {"title", chapter.title},    {"introduction", chapter.introduction},
      {"version", chapter.version}, {"quick", chapter.is_quick}, {"seconds", chapter.seconds},
      {"figures", Json::object()},  {"units", Json::object()},   {"claims", Json::array()}};
  for (const Claim& claim : chapter.claims) {
    for (const KeyFigure& f : claim.figures) {
      json["figures"][f.name] = f.value;
      json["units"][f.name] = f.unit;
    }
    json["claims"].push_back(json_of(claim));
  }
  return json;
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

Verdict verdict_of(const std::string& words) {
  for (const Verdict v : kVerdicts) {
    if (to_string(v) == words) return v;
  }
  throw InputError("unknown verdict " + words);
}

Claim claim_of(const Json& json) {
  Claim claim{
      .title = json.at("title"), .source = json.at("source"), .verdict = verdict_of(json.at("verdict"))};
  claim.text = json.at("text").get<std::vector<std::string>>();
  for (const Json& f : json.at("figures"))
    claim.figures.push_back({f.at("name"), f.at("value"), f.at("unit"), f.at("aim"), f.at("tolerance")});
  for (const Json& t : json.at("tables")) {
    claim.tables.push_back({t.at("head").get<std::vector<std::string>>(),
                            t.at("rows").get<std::vector<std::vector<std::string>>>(), t.at("title")});
  }
  for (const Json& p : json.at("pictures"))
    claim.pictures.push_back({p.at("file"), p.at("caption"), p.at("svg")});
  return claim;
}

std::string format_value(const KeyFigure& figure) {
  return fmt::format("{:.4g}{}", figure.value, figure.unit == "1" ? "" : " " + figure.unit);
}

Table table_of(const std::vector<KeyFigure>& figures) {
  Table table{{"figure", "value", "aim"}, {}};
  for (const KeyFigure& f : figures) table.rows.push_back({"`" + f.name + "`", format_value(f), f.aim});
  return table;
}

/// All of a claim's tables, its figures first.
std::vector<Table> tables_of(const Claim& claim) {
  std::vector<Table> tables;
  if (!claim.figures.empty()) tables.push_back(table_of(claim.figures));
  tables.insert(tables.end(), claim.tables.begin(), claim.tables.end());
  return tables;
}

Table summary_of(const StudyReport& report) {
  Table table{{"claim", "by", "verdict"}, {}};
  for (const Chapter& chapter : report.chapters) {
    for (const Claim& claim : chapter.claims)
      table.rows.push_back({claim.title, claim.source, to_string(claim.verdict)});
  }
  return table;
}

std::string command_of(const Chapter& chapter) {
  return "weft study " + chapter.name + (chapter.is_quick ? " --quick" : "");
}

std::string words_about(const Chapter& chapter) {
  return fmt::format("`{}`, {:.0f} s here.", command_of(chapter), chapter.seconds);
}

std::string words_about(const StudyReport& report) {
  return fmt::format(
      "Weft {} on {}. Every figure comes from the command that stands under its chapter's title; times are "
      "this machine's, and compare with each other only.",
      report.version, report.machine);
}

// ---- Markdown

void add_row(const std::vector<std::string>& cells, std::string& text) {
  text += "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  text += "\n";
}

void add_table(const Table& table, std::string& text) {
  if (!table.title.empty()) text += table.title + "\n\n";
  add_row(table.head, text);
  text += "|";
  for (std::size_t i = 0; i < table.head.size(); ++i) text += i == 0 ? "---|" : "--:|";
  text += "\n";
  for (const auto& row : table.rows) add_row(row, text);
  text += "\n";
}

void add_claim(const Claim& claim, const std::string& pictures, std::string& text) {
  text += fmt::format("### {}\n\n*{}* — **{}**\n\n", claim.title, claim.source, to_string(claim.verdict));
  for (const std::string& paragraph : claim.text) text += paragraph + "\n\n";
  for (const Table& table : tables_of(claim)) add_table(table, text);
  for (const Figure2d& p : claim.pictures)
    text += fmt::format("![{}]({}/{})\n\n*{}*\n\n", p.caption, pictures, p.file, p.caption);
}

// ---- HTML

std::string escape(const std::string& text) {
  static const std::map<char, const char*> entities = {
      {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}};
  std::string safe;
  for (const char c : text) {
    const auto entity = entities.find(c);
    safe += entity == entities.end() ? std::string(1, c) : entity->second;
  }
  return safe;
}

/// The little Markdown there is in texts: `code`, **strong** and *emphasis*.
std::string inline_html(const std::string& text) {
  std::string html = escape(text);
  const auto mark = [&html](const std::string& sign, const std::string& tag) {
    bool open = false;
    for (auto at = html.find(sign); at != std::string::npos; at = html.find(sign, at)) {
      const std::string with = open ? "</" + tag + ">" : "<" + tag + ">";
      html.replace(at, sign.size(), with);
      at += with.size();
      open = !open;
    }
  };
  mark("`", "code");
  mark("**", "strong");
  return html;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned triple = 0;
    for (std::size_t k = 0; k < 3; ++k)
      triple = triple << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[triple >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw InputError(file.string() + ": cannot be read; run the study again, with this folder as --out");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string picture_html(const Figure2d& picture, const std::filesystem::path& folder) {
  const std::string image = picture.svg.empty() ? "<img alt=\"\" src=\"data:image/jpeg;base64," +
                                                      base64(read_bytes(folder / picture.file)) + "\">"
                                                : picture.svg;
  return "<figure>" + image + "<figcaption>" + inline_html(picture.caption) + "</figcaption></figure>\n";
}

std::string table_html(const Table& table) {
  const auto row = [](const std::vector<std::string>& cells, const std::string& tag) {
    std::string html = "<tr>";
    for (const std::string& cell : cells) html += "<" + tag + ">" + inline_html(cell) + "</" + tag + ">";
    return html + "</tr>\n";
  };
  std::string html = table.title.empty() ? "" : "<p>" + inline_html(table.title) + "</p>\n";
  html += "<table>" + row(table.head, "th");
  for (const auto& cells : table.rows) html += row(cells, "td");
  return html + "</table>\n";
}

std::string claim_html(const Claim& claim, const std::filesystem::path& folder) {
  std::string html = "<h3>" + inline_html(claim.title) + "</h3>\n<p><em>" + inline_html(claim.source) +
                     "</em> — <strong>" + to_string(claim.verdict) + "</strong></p>\n";
  for (const std::string& paragraph : claim.text) html += "<p>" + inline_html(paragraph) + "</p>\n";
  for (const Table& table : tables_of(claim)) html += table_html(table);
  for (const Figure2d& picture : claim.pictures) html += picture_html(picture, folder);
  return html;
}

constexpr const char* kPageHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Weft: the study</title>
<style>
body { font: 16px/1.5 sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 14px; display: block; overflow-x: auto; }
th, td { border-bottom: 1px solid #ddd; padding: .2rem .7rem; text-align: right; }
th:first-child, td:first-child { text-align: left; }
figure { margin: 1rem 0; } figcaption { color: #555; font-size: 14px; }
svg, img { max-width: 100%; height: auto; } h2 { border-top: 2px solid #ddd; padding-top: 1rem; }
code { background: #f3f3f3; padding: 0 .2rem; }
</style></head><body>
)";

}  // namespace

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::holds_in_part:
      return "holds in part";
    case Verdict::fails:
      return "does not hold";
    case Verdict::finding:
      break;
  }
  return "finding";
}

std::string to_json(const Chapter& chapter) { return dump(json_of(chapter)); }

std::string to_json(const StudyReport& report) {
  Json json = {{"version", report.version}, {"machine", report.machine}, {"chapters", Json::array()}};
  for (const Chapter& chapter : report.chapters) json["chapters"].push_back(json_of(chapter));
  return dump(json);
}

Chapter chapter_from_json(const std::string& text, const std::string& source) {
  try {
    const Json json = Json::parse(text);
    Chapter chapter{.name = json.at("study"),
                    .title = json.at("title"),
                    .introduction = json.at("introduction"),
                    .version = json.at("version"),
                    .is_quick = json.at("quick"),
                    .seconds = json.at("seconds")};
    for (const Json& claim : json.at("claims")) chapter.claims.push_back(claim_of(claim));
    return chapter;
  } catch (const Json::exception& error) {
    throw InputError(source + ": not a chapter of `weft study`: " + error.what());
  }
}

std::string summary(const StudyReport& report) {
  std::string text;
  for (const Chapter& chapter : report.chapters) {
    for (const Claim& claim : chapter.claims)
      text += fmt::format("{:<14} {}\n", to_string(claim.verdict), claim.title);
  }
  return text;
}

std::string to_markdown(const StudyReport& report, const std::string& pictures) {
  std::string text = "# The study\n\n" + words_about(report) + "\n\n";
  add_table(summary_of(report), text);
  for (const Chapter& chapter : report.chapters) {
    text += fmt::format("## {}\n\n{}\n\n{}\n\n", chapter.title, words_about(chapter), chapter.introduction);
    for (const Claim& claim : chapter.claims) add_claim(claim, pictures, text);
  }
  text.pop_back();
  return text;
}

std::string to_html(const StudyReport& report, const std::filesystem::path& folder) {
  std::string html = kPageHead;
  html += "<h1>Weft: the study</h1>\n<p>" + inline_html(words_about(report)) + "</p>\n";
  html += table_html(summary_of(report));
  for (const Chapter& chapter : report.chapters) {
    html += "<h2>" + inline_html(chapter.title) + "</h2>\n<p>" + inline_html(words_about(chapter)) +
            "</p>\n<p>" + inline_html(chapter.introduction) + "</p>\n";
    for (const Claim& claim : chapter.claims) html += claim_html(claim, folder);
  }
  return html + "</body></html>\n";
}

}  // namespace weft::engine
