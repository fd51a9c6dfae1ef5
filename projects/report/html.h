#pragma once
// One self-contained HTML page: no scripts, no fonts, no pictures from elsewhere.

#include <string>
#include <string_view>
#include <vector>

namespace seamwright::report {

// Text made safe for element content and quoted attributes.
std::string escape(std::string_view text);

// A verdict word with its colour; the word carries the meaning.
enum class Tone { neutral, good, attention, alarm };

class Page {
public:
    explicit Page(std::string title, std::string language = "en");
    void heading(std::string_view text, int level = 2);
    void paragraph(std::string_view text);
    void verdict(std::string_view word, Tone tone, std::string_view explanation = {});
    // First row is the head. Columns whose body cells are all numbers are right-aligned with tabular digits.
    void table(const std::vector<std::vector<std::string>>& rows, std::string_view caption = {});
    void figure(const std::string& svg, std::string_view caption = {});
    void figures(const std::vector<std::string>& svgs, std::string_view caption = {});  // side by side where there is room
    std::string html() const;

private:
    std::string title_, language_, body_;
};

}  // namespace seamwright::report
