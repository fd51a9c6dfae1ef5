#pragma once
// One page of text, tables and plots: as self-contained HTML (no scripts, no fonts, no pictures from
// elsewhere), or block by block for another renderer.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration/verdict.h"

namespace seamwright::report {

// Text made safe for element content and quoted attributes.
std::string escape(std::string_view text);

// A verdict word with its colour; the word carries the meaning.
enum class Tone { neutral, good, attention, alarm };
Tone tone_of(Verdict verdict);

using Rows = std::vector<std::vector<std::string>>;  // the first is the head

// Columns whose body cells are all numbers; they are right-aligned with tabular digits.
std::vector<bool> numeric_columns(const Rows& rows);

struct Block {
    enum class Kind { heading, paragraph, verdict, table, figures, signatures };
    Kind kind = Kind::paragraph;
    int level = 2;     // of a heading
    std::string text;  // or the caption
    std::string word;  // of a verdict
    Tone tone = Tone::neutral;
    Rows rows;                      // of a table; of signatures: the labels of each line's fields
    std::vector<std::string> svgs;  // side by side where there is room
};

class Page {
  public:
    explicit Page(std::string title, std::string language = "en");
    void heading(std::string_view text, int level = 2);
    void paragraph(std::string_view text);
    void verdict(std::string_view word, Tone tone, std::string_view explanation = {});
    void table(const Rows& rows, std::string_view caption = {});
    void figure(const std::string& svg, std::string_view caption = {});
    void figures(const std::vector<std::string>& svgs, std::string_view caption = {});
    // Lines to be filled in by hand, each with the labels of its fields below it.
    void signatures(const Rows& lines);

    const std::string& title() const { return title_; }
    const std::string& language() const { return language_; }
    std::span<const Block> blocks() const { return blocks_; }
    std::string html() const;
    // The same, asked for again by the browser: no script runs here.
    std::string html_again_after(int seconds) const;
    // Headings, verdicts, sentences and tables, without the plots.
    std::string text() const;

  private:
    std::string title_, language_;
    std::vector<Block> blocks_;
};

}  // namespace seamwright::report
