#include "lab/report/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "weft/error.h"

namespace weft::engine::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr Verdict kVerdicts[] = {Verdict::holds, Verdict::holds_in_part, Verdict::fails, Verdict::finding};

Json json_of(const Hypothesis& hypothesis) {
  Json json = {
      {"title", hypothesis.title}, {"source", hypothesis.source}, {"verdict", to_string(hypothesis.verdict)},
      {"text", hypothesis.text},   {"figures", Json::array()},    {"tables", Json::array()},
      {"pictures", Json::array()}};
  for (const Metric& f : hypothesis.found.metrics) {
    json["figures"].push_back(
        {{"name", f.name}, {"value", f.value}, {"unit", f.unit}, {"aim", f.aim}, {"tolerance", f.tolerance}});
  }
  for (const Table& t : hypothesis.found.tables)
    json["tables"].push_back({{"title", t.title}, {"head", t.head}, {"rows", t.rows}});
  for (const ReportPicture& p : hypothesis.found.pictures)
    json["pictures"].push_back({{"file", p.file}, {"caption", p.caption}, {"svg", p.svg}});
  return json;
}

Json json_of(const Section& section) {
  Json json = {
      {"study", section.name},      {"title", section.title},    {"introduction", section.introduction},
      {"version", section.version}, {"quick", section.is_quick}, {"seconds", section.seconds},
      {"figures", Json::object()},  {"units", Json::object()},   {"claims", Json::array()}};
  for (const Hypothesis& hypothesis : section.hypotheses) {
    for (const Metric& f : hypothesis.found.metrics) {
      json["figures"][f.name] = f.value;
      json["units"][f.name] = f.unit;
    }
    json["claims"].push_back(json_of(hypothesis));
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

Hypothesis hypothesis_of(const Json& json) {
  Hypothesis hypothesis{
      .title = json.at("title"), .source = json.at("source"), .verdict = verdict_of(json.at("verdict"))};
  hypothesis.text = json.at("text").get<std::vector<std::string>>();
  for (const Json& f : json.at("figures"))
    hypothesis.found.metrics.push_back(
        {f.at("name"), f.at("value"), f.at("unit"), f.at("aim"), f.at("tolerance")});
  for (const Json& t : json.at("tables")) {
    hypothesis.found.tables.push_back({t.at("head").get<std::vector<std::string>>(),
                                       t.at("rows").get<std::vector<std::vector<std::string>>>(),
                                       t.at("title")});
  }
  for (const Json& p : json.at("pictures"))
    hypothesis.found.pictures.push_back({p.at("file"), p.at("caption"), p.at("svg")});
  return hypothesis;
}

std::string format_value(const Metric& figure) {
  return fmt::format("{:.4g}{}", figure.value, figure.unit == "1" ? "" : " " + figure.unit);
}

Table table_of(const std::vector<Metric>& figures) {
  Table table{{"metric", "value", "target"}, {}};
  for (const Metric& f : figures) table.rows.push_back({"`" + f.name + "`", format_value(f), f.aim});
  return table;
}

/// All tables of a hypothesis, the metrics first.
std::vector<Table> tables_of(const Hypothesis& hypothesis) {
  std::vector<Table> tables;
  if (!hypothesis.found.metrics.empty()) tables.push_back(table_of(hypothesis.found.metrics));
  tables.insert(tables.end(), hypothesis.found.tables.begin(), hypothesis.found.tables.end());
  return tables;
}

Table summary_of(const Report& report) {
  Table table{{"hypothesis", "source", "verdict"}, {}};
  for (const Section& section : report.sections) {
    for (const Hypothesis& hypothesis : section.hypotheses)
      table.rows.push_back({hypothesis.title, hypothesis.source, to_string(hypothesis.verdict)});
  }
  return table;
}

std::string command_of(const Section& section) {
  return "weft study " + section.name + (section.is_quick ? " --quick" : "");
}

std::string words_about(const Section& section) {
  return fmt::format("`{}`, run time {:.0f} s.", command_of(section), section.seconds);
}

std::string words_about(const Report& report) {
  return fmt::format(
      "Weft {} on {}. Every metric comes from the command under its section's title. Times are those of this "
      "machine, and comparable only with each other.",
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

void add_hypothesis(const Hypothesis& hypothesis, const std::string& pictures, std::string& text) {
  text += fmt::format("### {}\n\n*{}* — **{}**\n\n", hypothesis.title, hypothesis.source,
                      to_string(hypothesis.verdict));
  for (const std::string& paragraph : hypothesis.text) text += paragraph + "\n\n";
  for (const Table& table : tables_of(hypothesis)) add_table(table, text);
  for (const ReportPicture& p : hypothesis.found.pictures)
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

/// Converts the Markdown of texts: `code`, **strong** and *emphasis*.
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

std::string picture_html(const ReportPicture& picture, const std::filesystem::path& folder) {
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

std::string hypothesis_html(const Hypothesis& hypothesis, const std::filesystem::path& folder) {
  std::string html = "<h3>" + inline_html(hypothesis.title) + "</h3>\n<p><em>" +
                     inline_html(hypothesis.source) + "</em> — <strong>" + to_string(hypothesis.verdict) +
                     "</strong></p>\n";
  for (const std::string& paragraph : hypothesis.text) html += "<p>" + inline_html(paragraph) + "</p>\n";
  for (const Table& table : tables_of(hypothesis)) html += table_html(table);
  for (const ReportPicture& picture : hypothesis.found.pictures) html += picture_html(picture, folder);
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

bool Metric::is_as_expected() const { return !expected || std::abs(value - *expected) <= allowed; }

Metric expect(std::string name, double value, std::string unit, double expected, double allowed) {
  return {.name = std::move(name),
          .value = value,
          .unit = std::move(unit),
          .expected = expected,
          .allowed = allowed};
}

std::string digits(double value, int significant) { return fmt::format("{:.{}g}", value, significant); }

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

std::string to_json(const Section& section) { return dump(json_of(section)); }

std::string to_json(const Report& report) {
  Json json = {{"version", report.version}, {"machine", report.machine}, {"chapters", Json::array()}};
  for (const Section& section : report.sections) json["chapters"].push_back(json_of(section));
  return dump(json);
}

Section section_from_json(const std::string& text, const std::string& source) {
  try {
    const Json json = Json::parse(text);
    Section section{.name = json.at("study"),
                    .title = json.at("title"),
                    .introduction = json.at("introduction"),
                    .version = json.at("version"),
                    .is_quick = json.at("quick"),
                    .seconds = json.at("seconds")};
    for (const Json& hypothesis : json.at("claims")) section.hypotheses.push_back(hypothesis_of(hypothesis));
    return section;
  } catch (const Json::exception& error) {
    throw InputError(source + ": not a section of `weft study`: " + error.what());
  }
}

std::string summary(const Report& report) {
  std::string text;
  for (const Section& section : report.sections) {
    for (const Hypothesis& hypothesis : section.hypotheses)
      text += fmt::format("{:<14} {}\n", to_string(hypothesis.verdict), hypothesis.title);
  }
  return text;
}

std::string to_markdown(const Report& report, const std::string& pictures) {
  std::string text = "# The study\n\n" + words_about(report) + "\n\n";
  add_table(summary_of(report), text);
  for (const Section& section : report.sections) {
    text += fmt::format("## {}\n\n{}\n\n{}\n\n", section.title, words_about(section), section.introduction);
    for (const Hypothesis& hypothesis : section.hypotheses) add_hypothesis(hypothesis, pictures, text);
  }
  text.pop_back();
  return text;
}

std::string to_html(const Report& report, const std::filesystem::path& folder) {
  std::string html = kPageHead;
  html += "<h1>Weft: the study</h1>\n<p>" + inline_html(words_about(report)) + "</p>\n";
  html += table_html(summary_of(report));
  for (const Section& section : report.sections) {
    html += "<h2>" + inline_html(section.title) + "</h2>\n<p>" + inline_html(words_about(section)) +
            "</p>\n<p>" + inline_html(section.introduction) + "</p>\n";
    for (const Hypothesis& hypothesis : section.hypotheses) html += hypothesis_html(hypothesis, folder);
  }
  return html + "</body></html>\n";
}

}  // namespace weft::engine::lab
