#include "tools/evaluate/evaluation_document.h"

#include <algorithm>
#include <regex>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/evaluate/built_from_commit.h"

namespace roomcal::tools {

namespace {

constexpr const char* kPreamble =
    "# Evaluation\n\n"
    "Generated: each section is written by the command that it names, from the commit that it names. Edit the "
    "commands,\n"
    "not the figures.\n";

std::string begin_mark(std::string_view name) { return fmt::format("<!-- begin {} -->", name); }
std::string end_mark(std::string_view name) { return fmt::format("<!-- end {} -->", name); }

std::string text_of(const EvaluationSection& section, const std::string& commit) {
  std::string body = section.body;
  while (!body.empty() && body.back() == '\n') body.pop_back();
  return fmt::format("{}\n## {}\n`{}` at commit `{}`\n\n{}\n{}\n", begin_mark(section.name), section.title,
                     section.command_line, commit, body, end_mark(section.name));
}

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

/// A section's own text, without marks; empty and a line in `problems` if its marks are not as they should be.
std::string_view inside(std::string_view document, std::string_view name, std::vector<std::string>& problems) {
  const std::string begin = begin_mark(name), end = end_mark(name);
  const std::size_t from = document.find(begin), to = document.find(end);
  if (count(document, begin) != 1 || count(document, end) != 1 || to < from) {
    problems.push_back(fmt::format("section {}: want '{}' and, below it, '{}', once each", name, begin, end));
    return {};
  }
  return document.substr(from + begin.size(), to - from - begin.size());
}

void check_section(std::string_view text, std::string_view name, std::vector<std::string>& problems) {
  static const std::regex kHead("^\n## [^\n]+\n`roomcal evaluate [^`\n]+` at commit `[0-9a-f]{7,40}`\n\n");
  std::match_results<std::string_view::const_iterator> head;
  if (!std::regex_search(text.begin(), text.end(), head, kHead)) {
    problems.push_back(fmt::format("section {}: want a heading, then '`roomcal evaluate ...` at commit `hash`'", name));
  } else if (head.suffix().length() < 2) {
    problems.push_back(fmt::format("section {}: nothing in it", name));
  }
  if (text.find("<!-- ") != text.npos) problems.push_back(fmt::format("section {}: another one's mark in it", name));
}

}  // namespace

std::string with_section(std::string document, const EvaluationSection& section, const std::string& commit) {
  if (document.empty()) document = kPreamble;
  const std::string text = text_of(section, commit), begin = begin_mark(section.name);
  if (count(document, begin) == 0 && count(document, end_mark(section.name)) == 0) return document + "\n" + text;
  std::vector<std::string> problems;
  inside(document, section.name, problems);
  if (!problems.empty()) throw ToolError(problems[0] + "; mend them by hand");
  const std::size_t from = document.find(begin);
  const std::size_t to = document.find(end_mark(section.name)) + end_mark(section.name).size() + 1;  // and its newline
  return document.replace(from, to - from, text);
}

void write_section(const std::filesystem::path& document, const EvaluationSection& section) {
  std::string old;
  if (std::filesystem::exists(document)) old = read_text(document);
  try {
    write_atomic(document, with_section(old, section, built_from_commit()));
  } catch (const ToolError& error) {
    if (std::string_view(error.what()).starts_with(document.string())) throw;
    throw ToolError(fmt::format("{}: {}", document.string(), error.what()));
  }
}

std::vector<std::string> form_problems(std::string_view document, std::span<const std::string_view> names) {
  std::vector<std::string> problems;
  for (const std::string_view name : names) {
    const std::size_t before = problems.size();
    const std::string_view text = inside(document, name, problems);
    if (problems.size() == before) check_section(text, name, problems);
  }
  constexpr std::string_view kBegin = "<!-- begin ";
  for (std::size_t at = document.find(kBegin); at != document.npos; at = document.find(kBegin, at + 1)) {
    const std::string_view rest = document.substr(at + kBegin.size());
    const std::string_view name = rest.substr(0, rest.find(' '));
    if (std::find(names.begin(), names.end(), name) == names.end())
      problems.push_back(fmt::format("section {}: no command writes it", name));
  }
  return problems;
}

std::string markdown_table(std::span<const std::vector<std::string>> rows) {
  std::string table;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& cell : rows[i]) table += "| " + cell + " ";
    table += "|\n";
    if (i > 0) continue;
    for (std::size_t k = 0; k < rows[0].size(); ++k) table += "|---";
    table += "|\n";
  }
  return table;
}

}  // namespace roomcal::tools
