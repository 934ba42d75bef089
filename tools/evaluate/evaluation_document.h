#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace roomcal::tools {

/// What one subcommand of `roomcal evaluate` measured, as a section of EVALUATION.md. In the document it stands
/// between `<!-- begin NAME -->` and `<!-- end NAME -->`, with the command line and the commit under its heading.
struct EvaluationSection {
  std::string name;          ///< of the marks: small letters and dashes
  std::string title;         ///< of the heading
  std::string command_line;  ///< that measures the same again, options at their values
  std::string body;          ///< Markdown, without a heading of first or second level
};

/// The sections of the EVALUATION.md that is committed; a test looks whether they all are in it, in form.
inline constexpr std::array<std::string_view, 2> kCommittedSections = {"paper", "shots"};

/// The document with this section in its old one's place, or at the end; everything outside the marks is kept. An empty
/// document gets its heading first.
/// @param commit  of the program that measured, as built_from_commit() says it
/// @throws ToolError if the marks of the section are damaged.
std::string with_section(std::string document, const EvaluationSection& section, const std::string& commit);

/// Puts the section into the file, which may not exist yet, in one step.
/// @throws ToolError naming the path: it cannot be read or written, or its marks are damaged.
void write_section(const std::filesystem::path& document, const EvaluationSection& section);

/// What is wrong with the form of a document, one line each: a section that is missing, unknown or twice there, marks
/// that do not match, a section without heading, command line, commit or content. Figures are not judged.
/// @param names  of the sections that it must have, and no others
std::vector<std::string> form_problems(std::string_view document, std::span<const std::string_view> names);

/// A table in Markdown. @param rows  the first one is the heading; all of one length, no '|' in them
std::string markdown_table(std::span<const std::vector<std::string>> rows);

}  // namespace roomcal::tools
